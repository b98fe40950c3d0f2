//! Formats and sizes of images, read from their headers without any allocation by a decoder.

use std::io::{BufRead, Read as _, Seek};

use super::{TextureLimits, fault, ktx2};
use crate::world::gltf::Fault;

/// Source of encoded bytes.
pub trait Input: BufRead + Seek {}
impl<T: BufRead + Seek> Input for T {}

/// A supported format.
#[derive(Clone, Copy)]
pub enum Format {
    /// ISO/IEC 15948.
    Png,
    /// ITU-T T.81.
    Jpeg,
    /// RFC 9649.
    WebP,
    /// KTX 2.0 with Basis Universal.
    Ktx2,
}

/// Format by content, since names and MIME types are often wrong.
fn sniff(input: &mut dyn Input) -> Result<Format, Fault> {
    let mut magic = Vec::new();
    let unreadable = |e: std::io::Error| fault("image-broken", format!("cannot be read: {e}"));
    input.take(12).read_to_end(&mut magic).map_err(unreadable)?;
    input.rewind().map_err(unreadable)?;
    let unsupported = |what: &str| {
        Err(fault(
            "image-unsupported",
            format!("is {what}, expected PNG, JPEG, WebP or KTX2"),
        )
        .help("convert the image to PNG"))
    };
    match magic.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => Ok(Format::Png),
        [0xFF, 0xD8, 0xFF, ..] => Ok(Format::Jpeg),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P'] => Ok(Format::WebP),
        magic if magic == ktx2::IDENTIFIER => Ok(Format::Ktx2),
        [0xAB, b'K', b'T', b'X', ..] => unsupported("KTX 1"),
        [b'D', b'D', b'S', b' ', ..] => unsupported("DDS"),
        [b'G', b'I', b'F', b'8', ..] => unsupported("GIF"),
        [b'B', b'M', ..] => unsupported("BMP"),
        [] => Err(fault("image-broken", "is empty")),
        _ => unsupported("of an unknown format"),
    }
}

/// Width and height without any allocation by a decoder.
fn peek_size(input: &mut dyn Input, format: Format) -> Result<[u32; 2], Fault> {
    let cut = |_| fault("image-broken", "its header is cut off");
    let size = match format {
        Format::Png => {
            let mut head = [0; 24]; // signature, IHDR's length and type, width, height
            input.read_exact(&mut head).map_err(cut)?;
            if head[12..16] != *b"IHDR" {
                return Err(fault("image-broken", "its first PNG chunk is not IHDR"));
            }
            [16, 20]
                .map(|at| u32::from_be_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]))
        }
        Format::Jpeg => jpeg_size(input)?,
        Format::WebP => webp_size(input)?,
        Format::Ktx2 => ktx2::size(input)?,
    };
    input.rewind().map_err(cut)?;
    Ok(size)
}

/// Size in the first chunk of a WebP file: `VP8X`, `VP8L` or `VP8 ` (RFC 9649, 2.5 to 2.7).
fn webp_size(input: &mut dyn Input) -> Result<[u32; 2], Fault> {
    let broken = |text: &str| fault("image-broken", text);
    // RIFF header, chunk header, the first bytes of the chunk, of which VP8L may have fewer.
    let mut head = Vec::with_capacity(30);
    (input.take(30).read_to_end(&mut head)).map_err(|_| broken("it cannot be read"))?;
    if head.len() < 25 {
        return Err(broken("its header is cut off"));
    }
    head.resize(30, 0);
    let u24 = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], 0]);
    match &head[12..16] {
        b"VP8X" => Ok([u24(24) + 1, u24(27) + 1]),
        b"VP8L" if head[20] == 0x2F => {
            let bits = u32::from_le_bytes([head[21], head[22], head[23], head[24]]);
            Ok([(bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1])
        }
        b"VP8 " if head[23..26] == [0x9D, 0x01, 0x2A] => {
            Ok([26, 28].map(|at| u32::from(head[at]) | u32::from(head[at + 1] & 0x3F) << 8))
        }
        _ => Err(broken("its first WebP chunk is not a picture")),
    }
}

/// Walks the JPEG segments up to the frame header (ITU-T T.81, B.2.2).
fn jpeg_size(input: &mut dyn Input) -> Result<[u32; 2], Fault> {
    let cut = |_| fault("image-broken", "its header is cut off");
    let mut word = [0; 2];
    input.read_exact(&mut word).map_err(cut)?;
    loop {
        let mut byte = [0];
        // Segments may be preceded by any number of fill bytes.
        while byte[0] != 0xFF {
            input.read_exact(&mut byte).map_err(cut)?;
        }
        while byte[0] == 0xFF {
            input.read_exact(&mut byte).map_err(cut)?;
        }
        let marker = byte[0];
        if matches!(marker, 0x00 | 0x01 | 0xD0..=0xD8) {
            continue;
        }
        input.read_exact(&mut word).map_err(cut)?;
        let length = i64::from(u16::from_be_bytes(word));
        match marker {
            0xC4 | 0xC8 | 0xCC => {} // tables, which share the range of frame headers
            0xC0..=0xCF => {
                let mut frame = [0; 5];
                input.read_exact(&mut frame).map_err(cut)?;
                let side = |at: usize| u32::from(u16::from_be_bytes([frame[at], frame[at + 1]]));
                return Ok([side(3), side(1)]);
            }
            0xD9 | 0xDA => return Err(fault("image-broken", "it has no frame header")),
            _ => {}
        }
        input.seek_relative((length - 2).max(0)).map_err(cut)?;
    }
}

/// Format and size, if the size is allowed; leaves `input` at its start.
pub fn header(input: &mut dyn Input, limits: &TextureLimits) -> Result<(Format, [u32; 2]), Fault> {
    let format = sniff(input)?;
    let [width, height] = peek_size(input, format)?;
    let most = limits.max_px;
    if ![width, height].iter().all(|side| (1..=most).contains(side)) {
        let text = format!("is {width} × {height} pixels, expected 1 to {most} each");
        return Err(fault("image-too-large", text).help("scale the image down"));
    }
    Ok((format, [width, height]))
}
