//! KTX 2.0 with Basis Universal, as KHR_texture_basisu has it: ETC1S and UASTC become RGBA.

use basisu::{DecodeFlags, SourceFormat, Supercompression, TargetFormat, Transcoder};
use image::RgbaImage;

use super::fault;
use crate::gltf::Fault;

/// Offset of the first level's entry: byte offset, length and inflated length (KTX 2.0 §3, "Level Index").
const FIRST_LEVEL: usize = 80;
/// Number of bytes up to the end of the first level's entry.
const HEADER_BYTES: usize = 104;
/// Largest window of Zstandard that is always allowed, bytes: what every decoder should support (RFC 8878, 3.1.1.1.2).
const SMALL_WINDOW_BYTES: u64 = 8 << 20;

/// A KTX 2 file whose header was read.
pub struct Ktx2<'a> {
    bytes: &'a [u8],
    transcoder: Transcoder<'a>,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

fn broken(text: &str) -> Fault {
    fault("image-broken", text)
}

impl<'a> Ktx2<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// Formats other than those of KHR_texture_basisu, broken headers.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        if bytes.len() < HEADER_BYTES {
            return Err(broken("its header is cut off"));
        }
        let unsupported = |what: String| {
            let text = format!("is KTX with {what}, expected Basis Universal");
            fault("image-unsupported", text).help("convert the image to PNG")
        };
        let vk_format = u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]);
        if vk_format != 0 {
            return Err(unsupported(format!("vkFormat {vk_format}")));
        }
        let transcoder = Transcoder::new(bytes).map_err(cannot)?;
        match transcoder.source_format() {
            SourceFormat::Etc1s | SourceFormat::UastcLdr => {}
            other => return Err(unsupported(format!("{other:?}"))),
        }
        let (width, height) = transcoder.base_dimensions();
        Ok(Self {
            bytes,
            transcoder,
            size: [width, height],
        })
    }

    /// Upper bound of the memory for decoding, bytes, without the pixels.
    ///
    /// # Errors
    /// Lengths that do not fit the picture.
    pub fn working_bytes(&self) -> Result<u64, Fault> {
        let [width, height] = self.size;
        let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
        let block_bytes = blocks * 16;
        if self.transcoder.supercompression() != Supercompression::Zstandard {
            // Codebooks are at most as large as 16-bit indices allow.
            return Ok(block_bytes + (8 << 20));
        }
        let word = |at: usize| {
            let at = FIRST_LEVEL + at;
            self.bytes[at..at + 8]
                .iter()
                .rev()
                .fold(0, |value, &b| value << 8 | u64::from(b))
        };
        let inflated = word(16);
        if inflated > block_bytes {
            return Err(broken("its first level is larger than its picture"));
        }
        let range = usize::try_from(word(0)).ok().and_then(|start| {
            let length = usize::try_from(word(8)).ok()?;
            Some(start..start.checked_add(length)?)
        });
        let stream = range.and_then(|range| self.bytes.get(range));
        let stream = stream.ok_or_else(|| broken("its first level lies outside the file"))?;
        // The decoder keeps a window of what it has inflated, and inflates up to a whole level beyond it.
        let (frame, _) = ruzstd::frame::read_frame_header(stream)
            .map_err(|_| broken("its first level is not a frame of Zstandard"))?;
        let window = frame.header.window_size();
        let window = window.map_err(|_| broken("its window of Zstandard is not allowed"))?;
        if window > inflated.max(SMALL_WINDOW_BYTES) {
            return Err(broken(
                "its window of Zstandard is larger than its first level",
            ));
        }
        // A buffer that grows by doubling is held twice while it is copied.
        Ok(inflated + 4 * (window + inflated))
    }

    /// Decodes the first mip level of the first picture.
    ///
    /// # Errors
    /// Broken data.
    pub fn decode(self) -> Result<RgbaImage, Fault> {
        let [width, height] = self.size;
        let rgba = (self.transcoder).transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
        RgbaImage::from_raw(width, height, rgba.map_err(cannot)?)
            .ok_or_else(|| broken("it decodes to another size than its header says"))
    }
}

fn cannot(e: basisu::Error) -> Fault {
    broken(&format!("cannot be decoded: {e:?}"))
}
