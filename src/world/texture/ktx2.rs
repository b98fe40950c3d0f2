//! KTX 2.0 with Basis Universal, as KHR_texture_basisu has it: ETC1S and UASTC become RGBA.

use std::io::Read;

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use image::RgbaImage;

use super::fault;
use crate::world::gltf::Fault;

/// First bytes of every KTX 2 file.
pub const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";

/// Number of bytes up to the end of the first level's entry (KTX 2.0 §3, "Header" and "Level Index").
const HEADER_BYTES: usize = 104;

fn broken(text: &str) -> Fault {
    fault("image-broken", text)
}

/// Width and height, after a check of the lengths by which a decoder would allocate.
///
/// # Errors
/// Other formats than those of Basis Universal, lengths that do not fit the picture.
pub fn size(input: &mut (impl Read + ?Sized)) -> Result<[u32; 2], Fault> {
    let mut head = [0; HEADER_BYTES];
    (input.read_exact(&mut head)).map_err(|_| broken("its header is cut off"))?;
    let word = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let (vk_format, [width, height]) = (word(12), [word(20), word(24)]);
    if vk_format != 0 {
        let text = format!("is KTX with vkFormat {vk_format}, expected Basis Universal");
        return Err(fault("image-unsupported", text).help("convert the image to PNG"));
    }
    let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
    let inflated = u64::from(word(96)) | u64::from(word(100)) << 32;
    if inflated > blocks * 16 {
        return Err(broken("its first level is larger than its picture"));
    }
    Ok([width, height])
}

/// Decodes the first mip level of the first picture.
///
/// # Errors
/// Broken data, high dynamic range.
pub fn decode(
    input: &mut (impl Read + ?Sized),
    [width, height]: [u32; 2],
) -> Result<RgbaImage, Fault> {
    let mut bytes = Vec::new();
    (input.read_to_end(&mut bytes)).map_err(|e| broken(&format!("cannot be read: {e}")))?;
    let cannot = |e: basisu::Error| broken(&format!("cannot be decoded: {e:?}"));
    let transcoder = Transcoder::new(&bytes).map_err(cannot)?;
    let rgba = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
    let rgba = RgbaImage::from_raw(width, height, rgba.map_err(cannot)?);
    rgba.ok_or_else(|| broken("it decodes to another size than its header says"))
}
