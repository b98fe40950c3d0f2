//! Basis Universal, in files of its own (`.basis`) and in KTX 2.0.

use super::{fault, floats::from_halves};
use crate::gltf::Fault;
use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder};

/// Memory of the codebooks of ETC1S, which are at most as large as 16-bit indices allow, bytes.
const CODEBOOK_BYTES: u64 = 8 << 20;
/// Bytes of a block of Basis Universal and of ASTC.
const BLOCK_BYTES: u64 = 16;

/// A picture whose header was read.
pub struct Basis<'a> {
    transcoder: Box<Transcoder<'a>>,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

impl<'a> Basis<'a> {
    /// Reads the header of a `.basis` or KTX 2 file.
    ///
    /// # Errors
    /// Broken headers; formats of floats but for UASTC HDR of 4 × 4 texels.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let transcoder = Box::new(Transcoder::new(bytes).map_err(cannot)?);
        match transcoder.source_format() {
            SourceFormat::Etc1s | SourceFormat::UastcLdr | SourceFormat::AstcLdr(_) => {}
            SourceFormat::UastcHdr4x4 => {}
            format => {
                let text = format!(
                    "is Basis Universal as {format:?}, expected ETC1S, UASTC, UASTC HDR of 4 × 4 texels or ASTC"
                );
                return Err(fault("image-unsupported", text).help("convert the image to PNG"));
            }
        }
        let size = transcoder.base_dimensions().into();
        Ok(Self { transcoder, size })
    }

    /// Whether its texels are floats.
    fn is_hdr(&self) -> bool {
        self.transcoder.source_format() == SourceFormat::UastcHdr4x4
    }

    /// Width and height of a block in texels, and its bytes.
    pub fn block(&self) -> ([u32; 2], u64) {
        let block = self.transcoder.source_format().block_dims();
        (block.into(), BLOCK_BYTES)
    }

    /// Upper bound of the memory for decoding, bytes, without the pixels. The size must have been checked.
    pub fn working_bytes(&self) -> u64 {
        let ([across, down], bytes) = self.block();
        let blocks =
            u64::from(self.size[0].div_ceil(across)) * u64::from(self.size[1].div_ceil(down));
        let [width, height] = self.size.map(u64::from);
        let floats = if self.is_hdr() { width * height * 8 } else { 0 };
        blocks * bytes + floats + CODEBOOK_BYTES
    }

    /// RGBA of a mip level, 0 being the largest. Floats are clamped to 1, and become sRGB with `srgb`.
    ///
    /// # Errors
    /// Broken data.
    pub fn decode(&self, level: u32, srgb: bool) -> Result<Vec<u8>, Fault> {
        // Texels as the formats specify them, without a filter across large blocks.
        let flags = DecodeFlags::NO_DEBLOCK_FILTERING;
        let texels = |format| {
            self.transcoder
                .transcode(level, format, flags)
                .map_err(cannot)
        };
        match self.is_hdr() {
            true => Ok(from_halves(&texels(TargetFormat::RgbaHalf)?, srgb)),
            false => texels(TargetFormat::Rgba32),
        }
    }
}

fn cannot(e: basisu::Error) -> Fault {
    fault("image-broken", format!("cannot be decoded: {e:?}"))
}
