//! Decodes PNG, JPEG, WebP and KTX2 into [`Texture`]s: headers first, within stated limits, on all cores.

use std::{
    fs::File,
    io::{BufReader, Cursor},
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
};

use image::{
    DynamicImage, ImageDecoder, Limits, RgbaImage,
    codecs::{jpeg::JpegDecoder, png::PngDecoder, webp::WebPDecoder},
};
use rayon::prelude::*;

use self::header::{Format, Input, header};
use super::{
    Texture,
    gltf::{Fault, ImageSource},
};
use crate::scene::diagnostic::Diagnostic;

mod header;
mod ktx2;
mod specular_glossiness;

/// Longest edge of a texture on the GPU, pixels; larger images are reduced to it.
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
    /// Name of the image in `file`, for messages.
    pub name: String,
    /// User of the image, for messages; may be empty.
    pub used_by: String,
    /// File for error messages.
    pub file: PathBuf,
    /// Encoded bytes.
    pub source: ImageSource,
    /// Whether the bytes are sRGB-encoded, see [`Texture::srgb`].
    pub srgb: bool,
}

impl TextureRequest {
    fn place(&self) -> String {
        match self.used_by.as_str() {
            "" => self.name.clone(),
            used_by => format!("{}, {used_by}", self.name),
        }
    }
}

fn fault(name: &'static str, text: impl Into<String>) -> Fault {
    Fault::new(name, text)
}

/// Decodes all requests, in their order.
///
/// # Errors
/// One error for every image that is broken, of another format, or too large; `image-budget` when all
/// together are more than the budget (found from the headers, before anything is decoded).
pub fn decode_all(
    requests: &[TextureRequest],
    limits: &TextureLimits,
) -> Result<Vec<Texture>, Vec<Diagnostic>> {
    let blame = |request: &TextureRequest, f: Fault| f.at(&request.place()).in_file(&request.file);
    let mut errors = Vec::new();
    let mut total = 0u64;
    let mut over = None;
    for request in requests {
        match guarded(|| num_pixels(&request.source, limits)) {
            Ok(pixels) => {
                total = total.saturating_add(pixels.saturating_mul(4));
                if total > limits.budget_bytes {
                    over.get_or_insert(request);
                }
            }
            Err(f) => report_once(&mut errors, blame(request, f)),
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
            Err(f) => report_once(&mut errors, blame(request, f)),
        }
    }
    if errors.is_empty() {
        Ok(textures)
    } else {
        Err(errors)
    }
}

/// Adds an error unless it is listed: two images that are made of the same maps have the same error.
fn report_once(errors: &mut Vec<Diagnostic>, error: Diagnostic) {
    if !errors.contains(&error) {
        errors.push(error);
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

/// Number of pixels that are decoded for an image, from its headers.
fn num_pixels(source: &ImageSource, limits: &TextureLimits) -> Result<u64, Fault> {
    match source {
        ImageSource::SpecularGlossiness(maps) => {
            let maps = [&maps.diffuse, &maps.specular].into_iter().flatten();
            let pixels: Result<Vec<_>, _> = maps.map(|map| num_pixels(map, limits)).collect();
            // The result is as large as the larger of both on each axis.
            Ok(pixels?.iter().sum::<u64>().saturating_mul(2))
        }
        source => {
            let (_, [width, height]) = header(&mut *open(source, limits)?, limits)?;
            Ok(u64::from(width) * u64::from(height))
        }
    }
}

fn open<'a>(source: &'a ImageSource, limits: &TextureLimits) -> Result<Box<dyn Input + 'a>, Fault> {
    let path = match source {
        ImageSource::Bytes(bytes) => return Ok(Box::new(Cursor::new(&**bytes))),
        ImageSource::File(path) => path,
        ImageSource::SpecularGlossiness(_) => {
            return Err(fault("internal", "a converted image has no bytes"));
        }
    };
    let unreadable = |e: std::io::Error| fault("file-unreadable", format!("cannot be read: {e}"));
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

fn broken(e: image::ImageError) -> Fault {
    match e {
        image::ImageError::Limits(_) => fault("image-too-large", format!("too large: {e}")),
        _ => fault("image-broken", format!("cannot be decoded: {e}")),
    }
}

/// Decodes an image after its header was checked.
fn decode_input(
    mut input: Box<dyn Input + '_>,
    limits: &TextureLimits,
) -> Result<RgbaImage, Fault> {
    let (format, [width, height]) = header(&mut *input, limits)?;
    // Room for 16-bit RGBA and the decoder's own needs (compressed text chunks count too).
    let mut own = Limits::no_limits();
    own.max_alloc = Some(u64::from(width) * u64::from(height) * 16 + (64 << 20));
    (own.max_image_width, own.max_image_height) = (Some(limits.max_px), Some(limits.max_px));
    let mut decoder: Box<dyn ImageDecoder> = match format {
        Format::Png => Box::new(PngDecoder::with_limits(input, own.clone()).map_err(broken)?),
        Format::Jpeg => Box::new(JpegDecoder::new(input).map_err(broken)?),
        Format::WebP => Box::new(WebPDecoder::new(input).map_err(broken)?),
        Format::Ktx2 => return ktx2::decode(&mut *input, [width, height]),
    };
    decoder.set_limits(own).map_err(broken)?;
    // Gray is expanded and 16 bits are reduced to 8; JPEG's CMYK arrives as RGB.
    let pixels = DynamicImage::from_decoder(decoder).map_err(broken)?;
    Ok(pixels.into_rgba8())
}

fn decode(request: &TextureRequest, limits: &TextureLimits) -> Result<Texture, Fault> {
    let pixels = pixels(&request.source, limits)?;
    let (width, height) = pixels.dimensions();
    Ok(Texture {
        name: format!("{}: {}", request.file.display(), request.name),
        width,
        height,
        rgba: pixels.into_raw(),
        srgb: request.srgb,
    })
}

fn pixels(source: &ImageSource, limits: &TextureLimits) -> Result<RgbaImage, Fault> {
    if let ImageSource::SpecularGlossiness(maps) = source {
        let decoded = |map: &Option<ImageSource>| {
            let pixels = map.as_ref().map(|map| pixels(map, limits));
            pixels.transpose()
        };
        let (diffuse, specular) = (decoded(&maps.diffuse)?, decoded(&maps.specular)?);
        return Ok(specular_glossiness::convert(maps, diffuse, specular));
    }
    decode_input(open(source, limits)?, limits)
}
