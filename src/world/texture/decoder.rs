//! One image from its header to RGBA. Sizes come from the header that the decoder itself reads, and every decoder has
//! an upper bound of its working memory.

use std::io::Cursor;

use image::{
    DynamicImage, ImageDecoder, Limits, RgbaImage,
    codecs::{png::PngDecoder, webp::WebPDecoder},
};

use super::{
    OTHER_SIZE, TextureLimits,
    basis::Basis,
    encoded::{Encoded, Format},
    fault,
    jpeg::Jpeg,
    ktx2::Ktx2,
    webp::{self, Watched},
};
use crate::gltf::Fault;

/// Smallest and largest limit of the memory for the text and color profiles of a PNG file, bytes.
const PNG_METADATA_BYTES: [u64; 2] = [16 << 20, 64 << 20];
/// Memory of any decoder beside its image, bytes.
const SMALL_BYTES: u64 = 1 << 20;

/// Memory of a decoded image, bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Need {
    /// Bytes of the decoded image and its levels, 4 per pixel, which are kept.
    pub kept: u64,
    /// Upper bound of the further bytes that are taken while the image is decoded.
    pub working: u64,
}

/// An image whose header was read.
pub struct Opened<'a> {
    decoder: Decoder<'a>,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Memory that decoding takes.
    pub need: Need,
}

enum Decoder<'a> {
    Jpeg(Box<Jpeg<'a>>),
    Ktx2(Box<Ktx2<'a>>),
    Basis(Basis<'a>),
    Other(Box<dyn ImageDecoder + 'a>),
}

impl<'a> Opened<'a> {
    /// Reads the header of an image, within the limits.
    ///
    /// # Errors
    /// Broken headers, sizes past the limits.
    pub fn new(encoded: &'a Encoded, limits: &TextureLimits) -> Result<Self, Fault> {
        let bytes: &[u8] = &encoded.bytes;
        let mut texels = None;
        let (decoder, size, working) = match encoded.format {
            Format::Jpeg => {
                let jpeg = Jpeg::open(bytes)?;
                let working = jpeg.working_bytes();
                let size = jpeg.size;
                (Decoder::Jpeg(Box::new(jpeg)), size, working)
            }
            Format::Ktx2 => {
                let ktx2 = Ktx2::open(bytes)?;
                let size = ktx2.size;
                check_size(size, limits)?;
                let working = ktx2.working_bytes()?;
                texels = Some(ktx2.texels());
                (Decoder::Ktx2(Box::new(ktx2)), size, working)
            }
            Format::Basis => {
                let basis = Basis::open(bytes)?;
                let (size, working) = (basis.size, basis.working_bytes());
                (Decoder::Basis(basis), size, working)
            }
            Format::Png => {
                let png = PngDecoder::with_limits(Cursor::new(bytes), png_limits(bytes, limits));
                let png = png.map_err(broken)?;
                let size = png.dimensions().into();
                let working = png
                    .total_bytes()
                    .saturating_add(2 * png_metadata_bytes(bytes));
                (Decoder::Other(Box::new(png)), size, working)
            }
            Format::WebP => {
                let watched = Watched::new(bytes);
                let decoder = WebPDecoder::new(watched).map_err(broken)?;
                let size = decoder.dimensions().into();
                let working = webp::working_bytes(bytes, size);
                (Decoder::Other(Box::new(decoder)), size, working)
            }
        };
        check_size(size, limits)?;
        let need = Need {
            kept: texels.unwrap_or(u64::from(size[0]) * u64::from(size[1])) * 4,
            working: working.saturating_add(SMALL_BYTES),
        };
        Ok(Self {
            decoder,
            size,
            need,
        })
    }

    /// Decodes the image, and the levels that it states, each half as large; gray is expanded, 16 bits are reduced to 8,
    /// and floats become sRGB with `srgb`. Also says what is damaged in an image that can be shown.
    ///
    /// # Errors
    /// Broken data.
    pub fn decode(self, srgb: bool) -> Result<(Vec<RgbaImage>, Option<Fault>), Fault> {
        let picture = match self.decoder {
            Decoder::Ktx2(ktx2) => return ktx2.decode(srgb),
            Decoder::Jpeg(jpeg) => {
                let (picture, damage) = jpeg.decode()?;
                return Ok((vec![picture], damage));
            }
            Decoder::Basis(basis) => {
                let rgba = basis.decode(0, srgb)?;
                let picture = RgbaImage::from_raw(self.size[0], self.size[1], rgba);
                picture.ok_or_else(|| fault("image-broken", OTHER_SIZE))?
            }
            Decoder::Other(decoder) => {
                let pixels = DynamicImage::from_decoder(decoder).map_err(broken)?;
                pixels.into_rgba8()
            }
        };
        Ok((vec![picture], None))
    }
}

/// Limit of the memory for text and color profiles, bytes. The decoder counts a text as it stands in the file and as
/// it is read.
fn png_metadata_bytes(bytes: &[u8]) -> u64 {
    let [least, most] = PNG_METADATA_BYTES;
    (bytes.len() as u64).saturating_mul(4).clamp(least, most)
}

fn png_limits(bytes: &[u8], limits: &TextureLimits) -> Limits {
    let mut own = Limits::no_limits();
    own.max_alloc = Some(png_metadata_bytes(bytes));
    (own.max_image_width, own.max_image_height) = (Some(limits.max_px), Some(limits.max_px));
    own
}

fn check_size([width, height]: [u32; 2], limits: &TextureLimits) -> Result<(), Fault> {
    let most = limits.max_px;
    if [width, height].iter().all(|side| (1..=most).contains(side)) {
        return Ok(());
    }
    let text = format!("is {width} × {height} pixels, expected 1 to {most} each");
    Err(fault("image-too-large", text).help("scale the image down"))
}

fn broken(e: image::ImageError) -> Fault {
    match e {
        image::ImageError::Limits(_) => fault("image-too-large", format!("too large: {e}"))
            .help("scale the image down, or save it without color profiles and texts"),
        _ => fault("image-broken", format!("cannot be decoded: {e}")),
    }
}
