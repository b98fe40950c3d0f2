//! Memory of WebP: an upper bound by its headers, and a reader that ends the decoding where memory runs short.

use std::io::{self, BufRead, Cursor, Read, Seek, SeekFrom};

use reflet_base::memory;

/// Most bytes of intermediate planes for each pixel of the picture: RGB before it becomes RGBA, the frame of an
/// animation and its canvas, lossless alpha, and the small images of lossless transforms.
const PLANE_BYTES_PER_PIXEL: u64 = 14;
/// First bytes of the header of a lossy frame (RFC 6386, 9.1).
const FRAME_START: [u8; 3] = [0x9D, 0x01, 0x2A];
/// Encoded bytes that the decoder gets at once.
const STEP_BYTES: usize = 16 << 10;
/// Most memory that the prefix codes in [`STEP_BYTES`] become. Codes of 256 symbols in a table of 4 KiB take more
/// than 2 bytes each, and a lossless picture may have 65,536 groups of five.
const STEP_MEMORY_BYTES: u64 = 64 << 20;

/// Upper bound of the memory for decoding, bytes, without prefix codes, which [`Watched`] bounds.
pub fn working_bytes(bytes: &[u8], [width, height]: [u32; 2]) -> u64 {
    let pixels = u64::from(width) * u64::from(height);
    let planes = pixels * PLANE_BYTES_PER_PIXEL;
    planes + largest_frame_bytes(bytes) + bytes.len() as u64 + STEP_MEMORY_BYTES
}

/// Upper bound of the memory of a lossy frame, which is decoded before its size is compared with the picture's. A
/// frame has its header somewhere in the file, wherever the decoder looks for it.
pub fn largest_frame_bytes(bytes: &[u8]) -> u64 {
    let frames = bytes
        .windows(7)
        .filter(|window| window.starts_with(&FRAME_START));
    let frame_bytes = |window: &[u8]| {
        let side = |at: usize| {
            u64::from(u16::from_le_bytes([window[at], window[at + 1]]) & 0x3FFF)
                .next_multiple_of(16)
        };
        side(3) * side(5) * 3 / 2
    };
    frames.map(frame_bytes).max().unwrap_or(0)
}

/// Encoded bytes in small steps, each only while memory is left. Where the system does not tell it, prefix codes are
/// bounded by the size of the file alone.
pub struct Watched<'a> {
    bytes: Cursor<&'a [u8]>,
    /// Bytes of the current step that were read.
    read: usize,
}

impl<'a> Watched<'a> {
    /// A reader of all bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes: Cursor::new(bytes),
            read: STEP_BYTES,
        }
    }

    /// Begins another step after the last one.
    fn check(&mut self) -> io::Result<()> {
        if self.read < STEP_BYTES {
            return Ok(());
        }
        self.read = 0;
        match memory::available_bytes() {
            Some(left) if left < 2 * STEP_MEMORY_BYTES => {
                let text = "it takes more memory than is left";
                Err(io::Error::new(io::ErrorKind::OutOfMemory, text))
            }
            _ => Ok(()),
        }
    }
}

impl Read for Watched<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut available = self.fill_buf()?;
        let count = available.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Watched<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.check()?;
        let most = STEP_BYTES - self.read;
        let available = self.bytes.fill_buf()?;
        Ok(&available[..available.len().min(most)])
    }

    fn consume(&mut self, count: usize) {
        self.bytes.consume(count);
        self.read += count;
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes.seek(to)
    }
}
