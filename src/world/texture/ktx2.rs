//! KTX 2.0: Basis Universal and ASTC by its decoder, and the formats of `plain`.

use image::{RgbaImage, imageops};

use self::{header::Header, plain::Format};
use super::{basis::Basis, fault};
use crate::gltf::Fault;

mod header;
mod plain;

/// Color models of Basis Universal that are read (Khronos Data Format 1.4, §5.6).
const ETC1S: u8 = 163;
const UASTC: u8 = 166;
const UASTC_HDR: u8 = 167;
/// `VK_FORMAT_ASTC_4x4_SFLOAT_BLOCK`, as files of UASTC HDR have it.
const ASTC_4X4_FLOATS: u32 = 1_000_066_000;

/// A KTX 2 file whose header was read.
pub struct Ktx2<'a> {
    header: Header<'a>,
    content: Content<'a>,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

enum Content<'a> {
    Transcoded(Basis<'a>),
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
                "is KTX with {what}, expected Basis Universal (with floats: UASTC HDR of 4 × 4 texels), BC1 to BC7, ETC2, EAC, ASTC, or 1 to 4 channels of 8 or \
                 16 bits without sign or of 16-bit floats"
            ))
        };
        let models = match header.vk_format {
            0 => &[ETC1S, UASTC][..],
            ASTC_4X4_FLOATS => &[UASTC_HDR],
            format if plain::is_astc(format) => &[],
            format => return Err(other(format!("vkFormat {format}"))),
        };
        if let Some(model) = header.color_model
            && !(models.is_empty() || models.contains(&model))
        {
            return Err(other(format!("color model {model}")));
        }
        let basis = Basis::open(bytes)?;
        let size = basis.size;
        Ok(Self {
            header,
            content: Content::Transcoded(basis),
            size,
        })
    }

    /// Upper bound of the memory for decoding, bytes, without the pixels. The size must have been checked.
    ///
    /// # Errors
    /// Lengths that do not fit the picture.
    pub fn working_bytes(&self) -> Result<u64, Fault> {
        match &self.content {
            Content::Plain(format) => {
                let [width, height] = format.block_px();
                let across = u64::from(self.size[0].div_ceil(width));
                let blocks = across * u64::from(self.size[1].div_ceil(height));
                self.header
                    .inflating_bytes(blocks * format.block_bytes() as u64)
            }
            Content::Transcoded(basis) => {
                let inflating = self.header.inflating_bytes(basis.level_bytes())?;
                Ok(inflating + basis.working_bytes())
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
        let mut picture = match self.content {
            Content::Plain(format) => {
                let rgba = plain::decode(&self.header, format, srgb)?;
                RgbaImage::from_raw(width, height, rgba)
                    .ok_or_else(|| broken("it decodes to another size than its header says"))?
            }
            Content::Transcoded(basis) => basis.decode(srgb)?,
        };
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
