//! Writes the pictures that a comparison makes.

use std::{io::Cursor, path::Path};

use super::file_error;
use crate::scene::diagnostic::Diagnostic;

pub use crate::files::write_whole;

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
