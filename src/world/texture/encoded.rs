//! The encoded bytes of images, and their formats by content.

use std::io::Read as _;

use super::{TextureLimits, fault};
use crate::gltf::{
    Bytes, Fault, ImageSource,
    stand_in::{self, STAND_IN_BYTES},
};
use reflet_base::{files::File, memory::Reservation};

/// A supported format.
#[derive(Clone, Copy)]
pub enum Format {
    /// ISO/IEC 15948.
    Png,
    /// ITU-T T.81.
    Jpeg,
    /// RFC 9649.
    WebP,
    /// KTX 2.0.
    Ktx2,
    /// Basis Universal in a file of its own.
    Basis,
}

/// First bytes of the formats that are read.
const FORMATS: [(&[u8], Format); 4] = [
    (b"\x89PNG", Format::Png),
    (b"\xFF\xD8\xFF", Format::Jpeg),
    (b"\xABKTX 20\xBB\r\n\x1A\n", Format::Ktx2),
    (b"sB", Format::Basis),
];

/// First bytes of other formats, with their names.
const OTHERS: [(&[u8], &str); 12] = [
    (b"\xABKTX", "KTX 1"),
    (b"DDS ", "DDS"),
    (b"GIF8", "GIF"),
    (b"BM", "BMP"),
    (b"v/1\x01", "OpenEXR"),
    (b"#?R", "Radiance HDR"),
    (b"8BPS", "a file of Photoshop"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"\xFF\x0A", "JPEG XL"),
    (b"\0\0\0\x0CJXL ", "JPEG XL"),
    (b"<svg", "SVG"),
];

/// An encoded image in memory.
pub struct Encoded {
    /// Bytes of the image file.
    pub bytes: Bytes,
    /// Format that the first bytes tell.
    pub format: Format,
    /// Memory of the bytes, where they were read from a file.
    _held: Option<Reservation>,
}

impl Encoded {
    /// Reads an image, a file only as far as its format is supported and its size allowed. The memory for a file is
    /// held in the budget of `limits`.
    ///
    /// # Errors
    /// Files that cannot be read or are too large, formats that are not supported.
    pub fn read(source: &ImageSource, limits: &TextureLimits) -> Result<Self, Fault> {
        let path = match source {
            ImageSource::Bytes(bytes) => {
                return Ok(Self {
                    bytes: bytes.clone(),
                    format: format(bytes)?,
                    _held: None,
                });
            }
            ImageSource::File(path) => path,
            ImageSource::SpecularGlossiness(_) => {
                return Err(fault("internal", "a converted image has no bytes"));
            }
        };
        let unreadable =
            |e: std::io::Error| fault("file-unreadable", format!("cannot be read: {e}"));
        let mut file = File::open(path).map_err(unreadable)?;
        let size = file.metadata().map_err(unreadable)?.len();
        let too_large = |cap: u64| fault("file-too-large", format!("{size} bytes, at most {cap}"));
        if size > limits.max_file_bytes {
            return Err(too_large(limits.max_file_bytes));
        }
        let mut bytes = Vec::new();
        let mut start = (&mut file).take(STAND_IN_BYTES as u64);
        start.read_to_end(&mut bytes).map_err(unreadable)?;
        let format = format(&bytes)?;
        let held = limits.memory.hold(size);
        let held = held.ok_or_else(|| too_large(limits.memory.left()))?;
        let rest = size.saturating_sub(bytes.len() as u64);
        (bytes.try_reserve_exact(rest as usize)).map_err(|_| too_large(limits.memory.left()))?;
        // The file may grow meanwhile: memory was counted for its former length.
        file.take(rest)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
        Ok(Self {
            bytes: Bytes::new(bytes),
            format,
            _held: Some(held),
        })
    }
}

/// Format by content, since names and MIME types are often wrong.
fn format(bytes: &[u8]) -> Result<Format, Fault> {
    if let Some((_, format)) = FORMATS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Ok(*format);
    }
    let other = OTHERS.iter().find(|(start, _)| bytes.starts_with(start));
    let what = match (bytes.get(..4), bytes.get(4..8), bytes.get(8..12), other) {
        (Some(b"RIFF"), _, Some(b"WEBP"), _) => return Ok(Format::WebP),
        (_, Some(b"ftyp"), Some(b"heic" | b"heix" | b"mif1" | b"avif"), _) => "HEIC or AVIF",
        (.., Some((_, name))) => name,
        _ if bytes.is_empty() => return Err(fault("image-broken", "is empty")),
        _ => {
            stand_in::refuse(bytes)?;
            "of an unknown format"
        }
    };
    let text = format!("is {what}, expected PNG, JPEG, WebP or KTX2");
    Err(fault("image-unsupported", text).help("convert the image to PNG"))
}
