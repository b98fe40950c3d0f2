//! Writes files so that they are either whole or not there.

use std::{
    fs::{self, File},
    io::{self, Cursor, Write},
    path::Path,
};

use super::file_error;
use crate::scene::diagnostic::Diagnostic;

/// Writes `bytes` beside `path`, syncs them to the disk and moves them there in one step; what
/// was at `path` stays whole until then.
///
/// # Errors
/// When the folder cannot be written to or the disk is full; nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?;
    let mut beside = std::ffi::OsString::from(".");
    beside.push(name);
    beside.push(format!(".{}.tmp", std::process::id()));
    let beside = path.with_file_name(beside);
    let written = (|| {
        let mut file = File::create(&beside)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        drop(file);
        fs::rename(&beside, path)
    })();
    if written.is_err() {
        // The first error is the one worth telling.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// Writes an 8-bit sRGB PNG from tightly packed RGB bytes.
///
/// # Errors
/// As [`write_whole`], and when `rgb` is not `3 * width * height` bytes.
pub fn write_png(
    path: &Path,
    width: usize,
    height: usize,
    rgb: Vec<u8>,
) -> Result<(), Box<Diagnostic>> {
    let failed = |message: String| {
        let help = "choose a folder that exists and can be written to";
        file_error("unwritable-picture", path, message, help)
    };
    let mut encoded = Cursor::new(Vec::new());
    image::RgbImage::from_raw(width as u32, height as u32, rgb)
        .ok_or_else(|| failed(format!("the pixels are not {width} × {height}")))?
        .write_to(&mut encoded, image::ImageFormat::Png)
        .map_err(|e| failed(format!("cannot be encoded: {e}")))?;
    write_whole(path, encoded.get_ref()).map_err(|e| failed(format!("cannot be written: {e}")))
}
