//! Encodes the pictures that `compare` writes.

use std::{io::Cursor, path::Path};

use super::file_error;
use reflet_scene::diagnostic::Diagnostic;

/// Encodes an 8-bit sRGB PNG from tightly packed RGB bytes.
///
/// # Errors
/// Message, when `rgb` is not `3 * width * height` bytes.
pub fn encode_png(width: usize, height: usize, rgb: Vec<u8>) -> Result<Vec<u8>, String> {
    let mut encoded = Cursor::new(Vec::new());
    image::RgbImage::from_raw(width as u32, height as u32, rgb)
        .ok_or_else(|| format!("the pixels are not {width} × {height}"))?
        .write_to(&mut encoded, image::ImageFormat::Png)
        .map_err(|e| format!("cannot be encoded: {e}"))?;
    Ok(encoded.into_inner())
}

/// Error about a picture that cannot be written.
pub fn unwritable(path: &Path, message: &str) -> Box<Diagnostic> {
    let help = "choose a folder that exists and can be written to";
    file_error("unwritable-picture", path, message, help)
}
