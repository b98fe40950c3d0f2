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

/// First bytes of every KTX 2 file.
const KTX2_IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";

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
    let unsupported = |what: &str| {
        Err(fault(
            "image-unsupported",
            format!("is {what}, expected PNG, JPEG, WebP or KTX2"),
        )
        .help("convert the image to PNG"))
    };
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Ok(Format::Png),
        [0xFF, 0xD8, 0xFF, ..] => Ok(Format::Jpeg),
        [
            b'R',
            b'I',
            b'F',
            b'F',
            _,
            _,
            _,
            _,
            b'W',
            b'E',
            b'B',
            b'P',
            ..,
        ] => Ok(Format::WebP),
        bytes if bytes.starts_with(&KTX2_IDENTIFIER) => Ok(Format::Ktx2),
        [b's', b'B', ..] => Ok(Format::Basis),
        [0xAB, b'K', b'T', b'X', ..] => unsupported("KTX 1"),
        [b'D', b'D', b'S', b' ', ..] => unsupported("DDS"),
        [b'G', b'I', b'F', b'8', ..] => unsupported("GIF"),
        [b'B', b'M', ..] => unsupported("BMP"),
        [] => Err(fault("image-broken", "is empty")),
        _ => {
            stand_in::refuse(bytes)?;
            unsupported("of an unknown format")
        }
    }
}
