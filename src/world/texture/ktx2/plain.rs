//! Pictures of KTX 2.0 in formats of Vulkan: 8 and 16 bits a channel, and the blocks BC1 to BC7, ETC2 and EAC.

use half::f16;

use super::{
    super::floats::{float, unorm},
    header::Header,
};
use crate::gltf::Fault;

/// Texels along the side of a block.
const SIDE: usize = 4;
/// RGBA texels of a block, row by row.
type Texels = [[u8; 4]; SIDE * SIDE];

/// Format of the texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Channels one after another.
    Channels(Number, usize),
    /// The same with blue first, 8 bits each.
    BlueFirst(usize),
    Bc1 {
        has_alpha: bool,
    },
    Bc2,
    Bc3,
    Bc4,
    Bc5,
    Bc6 {
        is_signed: bool,
    },
    Bc7,
    Etc2,
    /// ETC2 with one bit of alpha.
    Etc2Mask,
    /// ETC2 with 8 bits of alpha.
    Etc2Alpha,
    /// EAC with so many channels.
    Eac(usize),
}

/// Type of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    U8,
    U16,
    F16,
}

impl Number {
    fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
        }
    }
}

/// Whether a `VkFormat` is ASTC with 8 bits a channel.
pub fn is_astc(vk_format: u32) -> bool {
    (157..=184).contains(&vk_format)
}

impl Format {
    /// The format of a `VkFormat`, whose sRGB variant decodes to the same bytes; `None` for all that is not decoded
    /// here.
    pub fn from_vulkan(vk_format: u32) -> Option<Self> {
        Some(match vk_format {
            9 | 15 => Self::Channels(Number::U8, 1),
            16 | 22 => Self::Channels(Number::U8, 2),
            23 | 29 => Self::Channels(Number::U8, 3),
            37 | 43 => Self::Channels(Number::U8, 4),
            30 | 36 => Self::BlueFirst(3),
            44 | 50 => Self::BlueFirst(4),
            70 => Self::Channels(Number::U16, 1),
            77 => Self::Channels(Number::U16, 2),
            84 => Self::Channels(Number::U16, 3),
            91 => Self::Channels(Number::U16, 4),
            76 => Self::Channels(Number::F16, 1),
            83 => Self::Channels(Number::F16, 2),
            90 => Self::Channels(Number::F16, 3),
            97 => Self::Channels(Number::F16, 4),
            131 | 132 => Self::Bc1 { has_alpha: false },
            133 | 134 => Self::Bc1 { has_alpha: true },
            135 | 136 => Self::Bc2,
            137 | 138 => Self::Bc3,
            139 => Self::Bc4,
            141 => Self::Bc5,
            143 => Self::Bc6 { is_signed: false },
            144 => Self::Bc6 { is_signed: true },
            145 | 146 => Self::Bc7,
            147 | 148 => Self::Etc2,
            149 | 150 => Self::Etc2Mask,
            151 | 152 => Self::Etc2Alpha,
            153 => Self::Eac(1),
            155 => Self::Eac(2),
            _ => return None,
        })
    }

    /// Width and height of a block; 1 where texels stand alone.
    pub fn block_px(self) -> [u32; 2] {
        match self {
            Self::Channels(..) | Self::BlueFirst(_) => [1; 2],
            _ => [SIDE as u32; 2],
        }
    }

    /// Bytes of a block, or of a texel that stands alone.
    pub fn block_bytes(self) -> usize {
        match self {
            Self::Channels(number, channels) => number.bytes() * channels,
            Self::BlueFirst(channels) => channels,
            Self::Bc1 { .. } | Self::Bc4 | Self::Etc2 | Self::Etc2Mask | Self::Eac(1) => 8,
            _ => 16,
        }
    }

    /// Whether there is no blue, so that two channels may be a normal.
    fn has_two_channels(self) -> bool {
        matches!(self, Self::Channels(_, 2) | Self::Bc5 | Self::Eac(2))
    }
}

/// RGBA of the picture. Missing colors are 0 and missing alpha is 1, as a sampler of Vulkan has them; of two channels
/// without `srgb` blue is the third coordinate of the unit normal that the others may be.
///
/// # Errors
/// Levels of another size.
pub fn decode(header: &Header<'_>, format: Format, srgb: bool) -> Result<Vec<u8>, Fault> {
    let [width, height] = header.size.map(|side| side as usize);
    let [across, down] =
        [0, 1].map(|axis| header.size[axis].div_ceil(format.block_px()[axis]) as usize);
    let level = header.level(across * down * format.block_bytes())?;
    let mut rgba = vec![0; width * height * 4];
    let blocks = level.chunks_exact(format.block_bytes());
    match format.block_px()[0] {
        1 => {
            for (texel, bytes) in rgba.chunks_exact_mut(4).zip(blocks) {
                texel.copy_from_slice(&single(format, bytes, srgb));
            }
        }
        _ => {
            for (k, bytes) in blocks.enumerate() {
                let texels = block(format, bytes, srgb);
                let [left, top] = [k % across * SIDE, k / across * SIDE];
                let used = SIDE.min(width - left);
                for (y, row) in texels.chunks_exact(SIDE).enumerate().take(height - top) {
                    let start = ((top + y) * width + left) * 4;
                    rgba[start..start + 4 * used].copy_from_slice(row[..used].as_flattened());
                }
            }
        }
    }
    if format.has_two_channels() && !srgb {
        rgba.chunks_exact_mut(4).for_each(|texel| {
            let [x, y] = [texel[0], texel[1]].map(|c| f32::from(c) / 127.5 - 1.0);
            texel[2] = unorm(0.5 + 0.5 * (1.0 - x * x - y * y).max(0.0).sqrt());
        });
    }
    Ok(rgba)
}

/// RGBA of a texel that stands alone.
fn single(format: Format, bytes: &[u8], srgb: bool) -> [u8; 4] {
    let mut rgba = [0, 0, 0, 255];
    match format {
        Format::BlueFirst(channels) => {
            rgba[..channels].copy_from_slice(bytes);
            rgba.swap(0, 2);
        }
        Format::Channels(Number::U8, channels) => rgba[..channels].copy_from_slice(bytes),
        _ => {
            for (k, two) in bytes.chunks_exact(2).enumerate() {
                let bits = u16::from_le_bytes([two[0], two[1]]);
                rgba[k] = match format {
                    Format::Channels(Number::F16, _) => {
                        float(f16::from_bits(bits).to_f32(), srgb && k < 3)
                    }
                    _ => ((u32::from(bits) * 255 + 32767) / 65535) as u8,
                };
            }
        }
    }
    rgba
}

/// RGBA of a block.
fn block(format: Format, bytes: &[u8], srgb: bool) -> Texels {
    const PITCH: usize = SIDE * 4;
    let mut rgba = [[0, 0, 0, 255]; SIDE * SIDE];
    let flat = rgba.as_flattened_mut();
    let (mut one, mut two) = ([0; SIDE * SIDE], [0; 2 * SIDE * SIDE]);
    match format {
        Format::Bc1 { .. } => bcdec_rs::bc1(bytes, flat, PITCH),
        Format::Bc2 => bcdec_rs::bc2(bytes, flat, PITCH),
        Format::Bc3 => bcdec_rs::bc3(bytes, flat, PITCH),
        Format::Bc7 => bcdec_rs::bc7(bytes, flat, PITCH),
        Format::Bc4 => {
            bcdec_rs::bc4(bytes, &mut one, SIDE, false);
            put(&mut rgba, 0, one);
        }
        Format::Bc5 => {
            bcdec_rs::bc5(bytes, &mut two, 2 * SIDE, false);
            put(&mut rgba, 0, std::array::from_fn(|i| two[2 * i]));
            put(&mut rgba, 1, std::array::from_fn(|i| two[2 * i + 1]));
        }
        Format::Bc6 { is_signed } => {
            let mut halves = [0; 3 * SIDE * SIDE];
            bcdec_rs::bc6h_half(bytes, &mut halves, 3 * SIDE, is_signed);
            for channel in 0..3 {
                let value = |i: usize| f16::from_bits(halves[3 * i + channel]).to_f32();
                put(
                    &mut rgba,
                    channel,
                    std::array::from_fn(|i| float(value(i), srgb)),
                );
            }
        }
        Format::Etc2 | Format::Etc2Mask | Format::Etc2Alpha => rgba = etc2(format, bytes),
        _ => {
            for (channel, bytes) in bytes.as_chunks().0.iter().enumerate() {
                put(&mut rgba, channel, eac_block(*bytes));
            }
        }
    }
    if format == (Format::Bc1 { has_alpha: false }) {
        put(&mut rgba, 3, [255; SIDE * SIDE]);
    }
    rgba
}

fn etc2(format: Format, bytes: &[u8]) -> Texels {
    let mut bgra = [0; SIDE * SIDE];
    match format {
        Format::Etc2Alpha => texture2ddecoder::decode_etc2_rgba8_block(bytes, &mut bgra),
        Format::Etc2Mask => texture2ddecoder::decode_etc2_rgba1_block(bytes, &mut bgra),
        _ => texture2ddecoder::decode_etc2_rgb_block(bytes, &mut bgra),
    }
    bgra.map(|texel| {
        let [blue, green, red, alpha] = texel.to_le_bytes();
        [red, green, blue, alpha]
    })
}

fn put(rgba: &mut Texels, channel: usize, values: [u8; SIDE * SIDE]) {
    for (texel, value) in rgba.iter_mut().zip(values) {
        texel[channel] = value;
    }
}

/// Modifiers of EAC by table and index (Khronos Data Format Specification 1.3, "R11 EAC").
const MODIFIERS: [[i32; 8]; 16] = [
    [-3, -6, -9, -15, 2, 5, 8, 14],
    [-3, -7, -10, -13, 2, 6, 9, 12],
    [-2, -5, -8, -13, 1, 4, 7, 12],
    [-2, -4, -6, -13, 1, 3, 5, 12],
    [-3, -6, -8, -12, 2, 5, 7, 11],
    [-3, -7, -9, -11, 2, 6, 8, 10],
    [-4, -7, -8, -11, 3, 6, 7, 10],
    [-3, -5, -8, -11, 2, 4, 7, 10],
    [-2, -6, -8, -10, 1, 5, 7, 9],
    [-2, -5, -8, -10, 1, 4, 7, 9],
    [-2, -4, -8, -10, 1, 3, 7, 9],
    [-2, -5, -7, -10, 1, 4, 6, 9],
    [-3, -4, -7, -10, 2, 3, 6, 9],
    [-1, -2, -3, -10, 0, 1, 2, 9],
    [-4, -6, -8, -9, 3, 5, 7, 8],
    [-3, -5, -7, -9, 2, 4, 6, 8],
];

/// The 4 × 4 texels of an EAC block of one channel with 11 bits, row by row, reduced to 8 bits.
fn eac_block(bytes: [u8; 8]) -> [u8; 16] {
    let bits = u64::from_be_bytes(bytes);
    let base = i32::from(bytes[0]) * 8 + 4;
    let step = match bytes[1] >> 4 {
        0 => 1,
        multiplier => i32::from(multiplier) * 8,
    };
    let table = &MODIFIERS[usize::from(bytes[1] & 15)];
    std::array::from_fn(|texel| {
        // Indices of 3 bits stand column by column, the first one highest.
        let (x, y) = (texel % 4, texel / 4);
        let index = bits >> (45 - 3 * (4 * x + y)) & 7;
        let value = (base + step * table[index as usize]).clamp(0, 2047);
        ((value * 255 + 1023) / 2047) as u8
    })
}
