//! Header of KTX 2.0 files (§3), and the bytes of a mip level with the memory that inflating them takes.

use ruzstd::io::Read as _;

use super::broken;
use crate::gltf::Fault;

/// Number of bytes up to the first level's entry, and of each entry.
const HEADER_BYTES: usize = 80;
const ENTRY_BYTES: usize = 24;
/// Largest window of Zstandard that is always allowed, bytes; every decoder should support it (RFC 8878, 3.1.1.1.2).
const SMALL_WINDOW_BYTES: u64 = 8 << 20;
/// Memory of an inflater of zlib, bytes.
const ZLIB_BYTES: u64 = 1 << 20;
/// Largest number of bytes that a byte of zlib becomes (RFC 1951: 258 by two codes of a bit).
const ZLIB_MOST_EXPANSION: u64 = 258 * 8 / 2;

/// Compression of a level as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Supercompression {
    None,
    /// Codebooks of ETC1S.
    BasisLz,
    Zstandard,
    Zlib,
}

/// Header of a file, seen from one of its levels.
#[derive(Clone)]
pub struct Header<'a> {
    pub vk_format: u32,
    /// Width and height of the level, pixels.
    pub size: [u32; 2],
    /// Color model of the data format descriptor (Khronos Data Format 1.4, §5.6); `None` without a descriptor.
    pub color_model: Option<u8>,
    /// Whether rows are stored from the right, and columns from below (`KTXorientation`, §5.2).
    pub is_reversed: [bool; 2],
    /// Channel 0 to 3, or 4 for 0 and 5 for 1, of each channel that is shown (`KTXswizzle`, §5.4).
    pub swizzle: [usize; 4],
    supercompression: Supercompression,
    file: &'a [u8],
    /// Bytes of the level, as they stand in the file.
    level: &'a [u8],
    /// Stated length of the inflated level, bytes.
    inflated: u64,
}

impl<'a> Header<'a> {
    /// Reads the header of a picture.
    ///
    /// # Errors
    /// Files that are cut off; cube maps, volumes and arrays; unknown supercompression.
    pub fn read(bytes: &'a [u8]) -> Result<Self, Fault> {
        if bytes.len() < HEADER_BYTES + ENTRY_BYTES {
            return Err(broken("its header is cut off"));
        }
        let word = |at: usize| number(&bytes[at..at + 4]) as u32;
        let [depth, layers, faces] = [28, 32, 36].map(word);
        if depth > 1 || layers > 1 || faces != 1 {
            let text = "is KTX with a cube map, a volume or an array, expected one picture";
            return Err(super::unsupported(text));
        }
        let supercompression = match word(44) {
            0 => Supercompression::None,
            1 => Supercompression::BasisLz,
            2 => Supercompression::Zstandard,
            3 => Supercompression::Zlib,
            other => {
                let text = format!("is KTX with supercompression {other}, expected 0 to 3");
                return Err(super::unsupported(text));
            }
        };
        let (level, inflated) =
            entry(bytes, 0).ok_or_else(|| broken("its first level lies outside the file"))?;
        let [descriptor, start, length] = [48, 56, 60].map(|at| word(at) as usize);
        let values = start
            .checked_add(length)
            .and_then(|end| bytes.get(start..end));
        let value = |key: &str| values.and_then(|values| value_of(values, key));
        let orientation = value("KTXorientation").unwrap_or_default();
        let is_swizzle =
            |value: &&[u8]| value.len() == 4 && value.iter().all(|c| SOURCES.contains(c));
        let swizzle = value("KTXswizzle").filter(is_swizzle).unwrap_or(b"rgba");
        let source = |k: usize| SOURCES.iter().position(|c| *c == swizzle[k]);
        Ok(Self {
            vk_format: word(12),
            // A picture of one dimension has no height.
            size: [word(20), word(24).max(1)],
            color_model: descriptor
                .checked_add(12)
                .and_then(|at| bytes.get(at).copied()),
            is_reversed: [
                orientation.first() == Some(&b'l'),
                orientation.get(1) == Some(&b'u'),
            ],
            swizzle: [0, 1, 2, 3].map(|k| source(k).unwrap_or(k)),
            supercompression,
            file: bytes,
            level,
            inflated,
        })
    }

    /// Number of levels that the file states and a picture of this size has.
    pub fn num_levels(&self) -> usize {
        let most = self.size[0].max(self.size[1]).max(1).ilog2() + 1;
        (number(&self.file[40..44]).max(1) as usize).min(most as usize)
    }

    /// The header as of the `k`th level below this first one; `None` where the file states no such level.
    pub fn below(&self, k: u32) -> Option<Self> {
        let is_stated = (k as usize) < self.num_levels();
        let (level, inflated) = entry(self.file, k as usize).filter(|_| is_stated)?;
        Some(Self {
            size: self.size.map(|side| (side >> k).max(1)),
            level,
            inflated,
            ..self.clone()
        })
    }

    /// Upper bound of the memory for inflating the level, bytes, with the inflated level itself, which has `bytes`, but
    /// for ETC1S.
    ///
    /// # Errors
    /// Another length; windows that are larger than the level.
    pub fn inflating_bytes(&self, bytes: u64) -> Result<u64, Fault> {
        let (least_stored, inflated) = match self.supercompression {
            Supercompression::BasisLz => return Ok(0),
            Supercompression::None => (bytes, bytes),
            Supercompression::Zlib => (bytes / ZLIB_MOST_EXPANSION, self.inflated),
            Supercompression::Zstandard => (0, self.inflated),
        };
        if (self.level.len() as u64) < least_stored {
            return Err(broken("its first level is cut off"));
        }
        if inflated != bytes {
            let text = "its first level is larger or smaller than its picture";
            return Err(broken(text));
        }
        match self.supercompression {
            Supercompression::Zlib => return Ok(inflated + ZLIB_BYTES),
            Supercompression::Zstandard => {}
            _ => return Ok(0),
        }
        // The decoder keeps a window of inflated bytes, and inflates up to a whole level beyond it.
        let (frame, _) = ruzstd::frame::read_frame_header(self.level)
            .map_err(|_| broken("its first level is not a frame of Zstandard"))?;
        let window = frame.header.window_size();
        let window = window.map_err(|_| broken("its window of Zstandard is not allowed"))?;
        if window > self.inflated.max(SMALL_WINDOW_BYTES) {
            return Err(broken(
                "its window of Zstandard is larger than its first level",
            ));
        }
        // A buffer that grows by doubling is held twice while it is copied.
        Ok(self.inflated + 4 * (window + self.inflated))
    }

    /// The inflated level, whose length must be `bytes`.
    ///
    /// # Errors
    /// Another length, broken data.
    pub fn level(&self, bytes: usize) -> Result<std::borrow::Cow<'a, [u8]>, Fault> {
        let cannot = || broken("its first level cannot be inflated to the size of its picture");
        let mut inflated = Vec::new();
        match self.supercompression {
            Supercompression::None => {
                let level = self.level.get(..bytes);
                let level = level.ok_or_else(|| broken("its first level is cut off"))?;
                return Ok(level.into());
            }
            Supercompression::BasisLz => return Err(broken("its supercompression needs ETC1S")),
            Supercompression::Zstandard => {
                let mut stream = ruzstd::StreamingDecoder::new(self.level).map_err(|_| cannot())?;
                inflated.resize(bytes, 0);
                stream.read_exact(&mut inflated).map_err(|_| cannot())?;
                if stream.read(&mut [0]).map_err(|_| cannot())? > 0 {
                    return Err(cannot());
                }
            }
            Supercompression::Zlib => {
                let stream = flate2::read::ZlibDecoder::new(self.level);
                inflated.reserve_exact(bytes + 1);
                let mut stream = std::io::Read::take(stream, bytes as u64 + 1);
                std::io::Read::read_to_end(&mut stream, &mut inflated).map_err(|_| cannot())?;
            }
        }
        match inflated.len() == bytes {
            true => Ok(inflated.into()),
            false => Err(cannot()),
        }
    }
}

/// Bytes of a level in the file, and its stated length when inflated; `None` for a level outside the file.
fn entry(file: &[u8], k: usize) -> Option<(&[u8], u64)> {
    let start = HEADER_BYTES + k * ENTRY_BYTES;
    let words = file.get(start..start + ENTRY_BYTES)?.as_chunks::<8>().0;
    let [start, length, inflated] = [0, 1, 2].map(|word| number(&words[word]));
    let start = usize::try_from(start).ok()?;
    let end = start.checked_add(usize::try_from(length).ok()?)?;
    Some((file.get(start..end)?, inflated))
}

/// Letters of a swizzle.
const SOURCES: [u8; 6] = *b"rgba01";

/// Value of a key without the zero at its end (§3.11): pairs with their lengths, each filled up to four bytes.
fn value_of<'a>(mut pairs: &'a [u8], key: &str) -> Option<&'a [u8]> {
    loop {
        let (length, rest) = pairs.split_at_checked(4)?;
        let length = number(length) as usize;
        let pair = rest.get(..length)?;
        let own = pair
            .strip_prefix(key.as_bytes())
            .and_then(|pair| pair.strip_prefix(b"\0"));
        if let Some(value) = own {
            return Some(value.strip_suffix(b"\0").unwrap_or(value));
        }
        pairs = rest.get(length.next_multiple_of(4)..)?;
    }
}

/// A little-endian number.
fn number(bytes: &[u8]) -> u64 {
    let digits = bytes.iter().rev();
    digits.fold(0, |value, &byte| value << 8 | u64::from(byte))
}
