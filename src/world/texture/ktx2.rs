//! KTX 2.0: Basis Universal and ASTC by its decoder, and the formats of `plain`.

use image::{RgbaImage, imageops};

use self::{header::Header, plain::Format};
use super::{OTHER_SIZE, basis::Basis, fault};
use crate::gltf::Fault;

mod header;
mod plain;

/// Color models of Basis Universal that are read (Khronos Data Format 1.4, §5.6).
const ETC1S: u8 = 163;
const UASTC: u8 = 166;
const UASTC_HDR: u8 = 167;
/// Memory that any level may take to inflate, bytes: five windows that every decoder of Zstandard should support.
const SMALL_BYTES: u64 = 40 << 20;
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
        let first = self.inflating_bytes(&self.header)?;
        let below = self
            .levels()
            .map(|level| self.inflating_bytes(&level).unwrap_or(0));
        let inflating = below.fold(first, u64::max);
        Ok(match &self.content {
            Content::Plain(_) => inflating,
            Content::Transcoded(basis) => inflating + basis.working_bytes(),
        })
    }

    fn inflating_bytes(&self, level: &Header<'_>) -> Result<u64, Fault> {
        let ([width, height], bytes) = match &self.content {
            Content::Plain(format) => (format.block_px(), format.block_bytes() as u64),
            Content::Transcoded(basis) => basis.block(),
        };
        let across = u64::from(level.size[0].div_ceil(width));
        level.inflating_bytes(across * u64::from(level.size[1].div_ceil(height)) * bytes)
    }

    /// The first mip level and the levels below it that take no more memory than it, or a small amount, to inflate.
    fn levels(&self) -> impl Iterator<Item = Header<'a>> {
        let most = self
            .inflating_bytes(&self.header)
            .unwrap_or(0)
            .max(SMALL_BYTES);
        let fits = move |level: &Header<'_>| self.inflating_bytes(level).is_ok_and(|b| b <= most);
        let below = (1..).map_while(|k| self.header.below(k));
        std::iter::once(self.header.clone()).chain(below.take_while(fits))
    }

    /// Number of texels of all levels.
    pub fn texels(&self) -> u64 {
        let levels = self.levels().map(|level| level.size.map(u64::from));
        levels.map(|[width, height]| width * height).sum()
    }

    /// Decodes the mip levels, the largest first and then as many as are not broken, upright and with their channels in
    /// their places; also says how many are left out. Numbers beyond 0 to 1 are clamped; floats are linear, and become
    /// sRGB with `srgb`.
    ///
    /// # Errors
    /// A broken first level.
    pub fn decode(self, srgb: bool) -> Result<(Vec<RgbaImage>, Option<Fault>), Fault> {
        let mut pictures = vec![self.picture(&self.header, 0, srgb)?];
        let below = self.levels().zip(0..).skip(1);
        pictures.extend(below.map_while(|(level, k)| self.picture(&level, k, srgb).ok()));
        let (stated, read) = (self.header.num_levels(), pictures.len());
        let damage = (read < stated).then(|| {
            let lost = stated - read;
            let text = format!(
                "{lost} of its {stated} levels are computed, as level {read} is broken or too large"
            );
            fault("image-damaged", text).help("export the image again")
        });
        Ok((pictures, damage))
    }

    fn picture(&self, level: &Header<'_>, k: u32, srgb: bool) -> Result<RgbaImage, Fault> {
        let rgba = match &self.content {
            Content::Plain(format) => plain::decode(level, *format, srgb)?,
            Content::Transcoded(basis) => basis.decode(k, srgb)?,
        };
        let (is_reversed, swizzle) = (level.is_reversed, level.swizzle);
        let mut picture = RgbaImage::from_raw(level.size[0], level.size[1], rgba)
            .ok_or_else(|| broken(OTHER_SIZE))?;
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
