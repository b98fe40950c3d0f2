//! KTX 2.0: Basis Universal and ASTC by its decoder, and the formats of `plain`.

use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder};
use image::{RgbaImage, imageops};

use self::{header::Header, plain::Format};
use super::fault;
use crate::gltf::Fault;

mod header;
mod plain;

/// Memory of the codebooks of ETC1S, which are at most as large as 16-bit indices allow, bytes.
const CODEBOOK_BYTES: u64 = 8 << 20;
/// Color models of Basis Universal that are read (Khronos Data Format 1.4, §5.6).
const ETC1S: u8 = 163;
const UASTC: u8 = 166;
/// Bytes of a block of Basis Universal and of ASTC.
const BLOCK_BYTES: u64 = 16;

/// A KTX 2 file whose header was read.
pub struct Ktx2<'a> {
    header: Header<'a>,
    content: Content<'a>,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

enum Content<'a> {
    Transcoded(Box<Transcoder<'a>>),
    Plain(Format),
}

fn broken(text: &str) -> Fault {
    fault("image-broken", text)
}

fn unsupported(text: impl Into<String>) -> Fault {
    fault("image-unsupported", text).help("convert the image to PNG")
}

impl<'a> Ktx2<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// Formats that are not supported, broken headers.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let header = Header::read(bytes)?;
        let size = header.size;
        if let Some(format) = Format::from_vulkan(header.vk_format) {
            return Ok(Self {
                header,
                content: Content::Plain(format),
                size,
            });
        }
        let other = |what: String| {
            unsupported(format!(
                "is KTX with {what}, expected Basis Universal, BC1 to BC7, ETC2, EAC, ASTC, or 1 to 4 channels of 8 or \
                 16 bits without sign or of 16-bit floats"
            ))
        };
        if header.vk_format != 0 && !plain::is_astc(header.vk_format) {
            return Err(other(format!("vkFormat {}", header.vk_format)));
        }
        if let Some(model) = header.color_model
            && header.vk_format == 0
            && ![ETC1S, UASTC].contains(&model)
        {
            return Err(other(format!("color model {model}")));
        }
        let transcoder = Transcoder::new(bytes).map_err(cannot)?;
        match transcoder.source_format() {
            SourceFormat::Etc1s | SourceFormat::UastcLdr | SourceFormat::AstcLdr(_) => {}
            format => return Err(other(format!("{format:?}"))),
        }
        let (width, height) = transcoder.base_dimensions();
        Ok(Self {
            header,
            content: Content::Transcoded(Box::new(transcoder)),
            size: [width, height],
        })
    }

    /// Upper bound of the memory for decoding, bytes, without the pixels. The size must have been checked.
    ///
    /// # Errors
    /// Lengths that do not fit the picture.
    pub fn working_bytes(&self) -> Result<u64, Fault> {
        let blocks = |[width, height]: [u32; 2]| {
            let [across, down] = [self.size[0].div_ceil(width), self.size[1].div_ceil(height)];
            u64::from(across) * u64::from(down)
        };
        match &self.content {
            Content::Plain(format) => {
                let level = blocks(format.block_px()) * format.block_bytes() as u64;
                self.header.inflating_bytes(level)
            }
            Content::Transcoded(transcoder) => {
                let level = blocks(transcoder.source_format().block_dims().into()) * BLOCK_BYTES;
                let working = self.header.inflating_bytes(level)?;
                Ok(working + level + CODEBOOK_BYTES)
            }
        }
    }

    /// Decodes the first mip level, upright and with its channels in their places. Numbers beyond 0 to 1 are clamped;
    /// floats are linear, and become sRGB with `srgb`.
    ///
    /// # Errors
    /// Broken data.
    pub fn decode(self, srgb: bool) -> Result<RgbaImage, Fault> {
        let [width, height] = self.size;
        let (is_reversed, swizzle) = (self.header.is_reversed, self.header.swizzle);
        let rgba = match self.content {
            Content::Plain(format) => plain::decode(&self.header, format, srgb)?,
            Content::Transcoded(transcoder) => transcoder
                // Texels as the formats specify them, without a filter across large blocks.
                .transcode(0, TargetFormat::Rgba32, DecodeFlags::NO_DEBLOCK_FILTERING)
                .map_err(cannot)?,
        };
        let mut picture = RgbaImage::from_raw(width, height, rgba)
            .ok_or_else(|| broken("it decodes to another size than its header says"))?;
        if swizzle != [0, 1, 2, 3] {
            for texel in picture.pixels_mut() {
                let [r, g, b, a] = texel.0;
                texel.0 = swizzle.map(|source| [r, g, b, a, 0, 255][source]);
            }
        }
        if is_reversed[0] {
            imageops::flip_horizontal_in_place(&mut picture);
        }
        if is_reversed[1] {
            imageops::flip_vertical_in_place(&mut picture);
        }
        Ok(picture)
    }
}

fn cannot(e: basisu::Error) -> Fault {
    broken(&format!("cannot be decoded: {e:?}"))
}
