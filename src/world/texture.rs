//! Decodes PNG and JPEG into [`Texture`]s: headers first, within stated limits, on all cores.

use std::{
    fs::File,
    io::{BufRead, BufReader, Cursor, Read, Seek},
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
};

use image::{
    DynamicImage, ImageDecoder, Limits, codecs::jpeg::JpegDecoder, codecs::png::PngDecoder,
};
use rayon::prelude::*;

use super::{
    Texture,
    gltf::{Fault, ImageSource},
};
use crate::scene::diagnostic::Diagnostic;

/// Longest edge that a picture is rendered with, pixels; larger images are reduced to it.
pub const LARGEST_KEPT_PX: u32 = 2048;

/// Limits of decoding.
#[derive(Clone, Copy, Debug)]
pub struct TextureLimits {
    /// Largest width and height, pixels.
    pub max_px: u32,
    /// Most decoded bytes of all images together.
    pub budget_bytes: u64,
    /// Largest encoded image file, bytes.
    pub max_file_bytes: u64,
}

/// An image to decode.
#[derive(Clone, Debug)]
pub struct TextureRequest {
    /// Which image of `file`, for messages.
    pub name: String,
    /// File for error messages.
    pub file: PathBuf,
    /// Encoded bytes.
    pub source: ImageSource,
    /// Becomes [`Texture::srgb`].
    pub srgb: bool,
}

#[derive(Clone, Copy)]
enum Format {
    Png,
    Jpeg,
}

trait Input: BufRead + Seek {}
impl<T: BufRead + Seek> Input for T {}

fn fault(name: &'static str, text: impl Into<String>) -> Fault {
    Fault::new(name, text)
}

/// Decodes all requests, in their order.
///
/// # Errors
/// One for every image that is broken, of another format, or too large; `image-budget` when all
/// together are more than the budget (found from the headers, before anything is decoded).
pub fn decode_all(
    requests: &[TextureRequest],
    limits: &TextureLimits,
) -> Result<Vec<Texture>, Vec<Diagnostic>> {
    let blame = |request: &TextureRequest, f: Fault| f.at(&request.name).in_file(&request.file);
    let mut errors = Vec::new();
    let mut total = 0u64;
    let mut over = None;
    for request in requests {
        match guarded(|| header(&mut *open(&request.source, limits)?, limits)) {
            Ok((_, [width, height])) => {
                total = total.saturating_add(u64::from(width) * u64::from(height) * 4);
                if total > limits.budget_bytes {
                    over.get_or_insert(request);
                }
            }
            Err(f) => errors.push(blame(request, f)),
        }
    }
    if let Some(request) = over {
        let text = format!(
            "the scene's images decode to {total} bytes, more than the budget of {} bytes",
            limits.budget_bytes
        );
        errors.push(blame(
            request,
            fault("image-budget", text).help("use smaller images"),
        ));
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let decoded: Vec<_> = (requests.par_iter())
        .map(|request| guarded(|| decode(request, limits)))
        .collect();
    let mut textures = Vec::with_capacity(decoded.len());
    for (request, result) in requests.iter().zip(decoded) {
        match result {
            Ok(texture) => textures.push(texture),
            Err(f) => errors.push(blame(request, f)),
        }
    }
    if errors.is_empty() {
        Ok(textures)
    } else {
        Err(errors)
    }
}

/// Panic boundary: third-party decoders process untrusted bytes.
fn guarded<T>(work: impl FnOnce() -> Result<T, Fault>) -> Result<T, Fault> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        Err(fault(
            "internal",
            "the image decoder panicked; please report this",
        ))
    })
}

fn open<'a>(source: &'a ImageSource, limits: &TextureLimits) -> Result<Box<dyn Input + 'a>, Fault> {
    match source {
        ImageSource::Bytes(bytes) => Ok(Box::new(Cursor::new(&**bytes))),
        ImageSource::File(path) => {
            let unreadable =
                |e: std::io::Error| fault("file-unreadable", format!("cannot be read: {e}"));
            let file = File::open(path).map_err(unreadable)?;
            let size = file.metadata().map_err(unreadable)?.len();
            if size > limits.max_file_bytes {
                let cap = limits.max_file_bytes;
                return Err(fault(
                    "file-too-large",
                    format!("{size} bytes, at most {cap}"),
                ));
            }
            Ok(Box::new(BufReader::new(file)))
        }
    }
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
            format!("is {what}, expected PNG or JPEG"),
        )
        .help("convert the image to PNG or JPEG"))
    };
    match magic.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => Ok(Format::Png),
        [0xFF, 0xD8, 0xFF, ..] => Ok(Format::Jpeg),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P'] => unsupported("WebP"),
        [0xAB, b'K', b'T', b'X', ..] => unsupported("KTX"),
        [b'D', b'D', b'S', b' ', ..] => unsupported("DDS"),
        [b'G', b'I', b'F', b'8', ..] => unsupported("GIF"),
        [b'B', b'M', ..] => unsupported("BMP"),
        [] => Err(fault("image-broken", "is empty")),
        _ => unsupported("of an unknown format"),
    }
}

fn broken(e: image::ImageError) -> Fault {
    match e {
        image::ImageError::Limits(_) => fault("image-too-large", format!("too large: {e}")),
        _ => fault("image-broken", format!("cannot be decoded: {e}")),
    }
}

/// A decoder that has read the header only, after that header was checked.
fn decoder<'a>(
    mut input: Box<dyn Input + 'a>,
    limits: &TextureLimits,
) -> Result<Box<dyn ImageDecoder + 'a>, Fault> {
    let (format, [width, height]) = header(&mut *input, limits)?;
    // Room for 16-bit RGBA and the decoder's own needs (compressed text chunks count too).
    let mut own = Limits::no_limits();
    own.max_alloc = Some(u64::from(width) * u64::from(height) * 16 + (64 << 20));
    (own.max_image_width, own.max_image_height) = (Some(limits.max_px), Some(limits.max_px));
    let mut decoder: Box<dyn ImageDecoder> = match format {
        Format::Png => Box::new(PngDecoder::with_limits(input, own.clone()).map_err(broken)?),
        Format::Jpeg => Box::new(JpegDecoder::new(input).map_err(broken)?),
    };
    decoder.set_limits(own).map_err(broken)?;
    Ok(decoder)
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
    };
    input.rewind().map_err(cut)?;
    Ok(size)
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
fn header(input: &mut dyn Input, limits: &TextureLimits) -> Result<(Format, [u32; 2]), Fault> {
    let format = sniff(input)?;
    let [width, height] = peek_size(input, format)?;
    let most = limits.max_px;
    if ![width, height].iter().all(|side| (1..=most).contains(side)) {
        let text = format!("is {width} × {height} pixels, expected 1 to {most} each");
        return Err(fault("image-too-large", text).help("scale the image down"));
    }
    Ok((format, [width, height]))
}

fn decode(request: &TextureRequest, limits: &TextureLimits) -> Result<Texture, Fault> {
    let decoder = decoder(open(&request.source, limits)?, limits)?;
    // Gray is expanded and 16 bits are reduced to 8; JPEG's CMYK arrives as RGB.
    let pixels = DynamicImage::from_decoder(decoder)
        .map_err(broken)?
        .into_rgba8();
    let (width, height) = pixels.dimensions();
    Ok(Texture {
        name: format!("{}: {}", request.file.display(), request.name),
        width,
        height,
        rgba: pixels.into_raw(),
        srgb: request.srgb,
    })
}
