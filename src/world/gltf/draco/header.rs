//! Header of a compressed stream (Draco bitstream 2.2), as far as it tells how much memory decoding takes.

use super::fault;
use crate::gltf::Fault;

/// Flag of a stream with metadata, which stands before the counts.
const METADATA_FLAG: u16 = 0x8000;
/// Largest depth of metadata in metadata that is read.
const MOST_NESTED: usize = 64;
/// Memory of an entry of metadata beside its bytes.
const ENTRY_BYTES: u64 = 256;

/// Header of a stream.
#[derive(Default)]
pub struct Header {
    /// Number of sets of attributes with seams of their own.
    pub num_attribute_sets: u64,
    /// Upper bound of the memory that the metadata takes.
    pub metadata_bytes: u64,
}

impl Header {
    /// Reads the header of a stream.
    ///
    /// # Errors
    /// Streams that are cut off, or of another version.
    pub fn read(stream: &[u8]) -> Result<Self, Fault> {
        let broken = || fault("its stream cannot be decoded: its header is broken or cut off");
        let mut rest = Cursor(stream);
        let start = rest.take(11).ok_or_else(broken)?;
        let (major, minor, method) = (start[5], start[6], start[8]);
        if (major, minor) != (2, 2) {
            let text =
                format!("its stream has Draco bitstream version {major}.{minor}, expected 2.2");
            return Err(fault(text).help("compress the file again with a newer encoder"));
        }
        let mut header = Self::default();
        if u16::from_le_bytes([start[9], start[10]]) & METADATA_FLAG != 0 {
            let num_entries = rest.geometry_metadata().ok_or_else(broken)?;
            let stored = (stream.len() - rest.0.len()) as u64;
            header.metadata_bytes = stored + num_entries * ENTRY_BYTES;
        }
        // Without Edgebreaker there are no seams.
        if method != 0 {
            header.num_attribute_sets = rest.num_attribute_sets().ok_or_else(broken)?;
        }
        Ok(header)
    }
}

/// Bytes that are left to read.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    /// A number of 7 bits a byte, the lowest first.
    fn variable(&mut self) -> Option<usize> {
        let length = 1 + self.0.iter().position(|byte| byte & 0x80 == 0)?;
        let mut digits = self.take(length)?.iter().rev();
        let add = |value: usize, byte: &u8| {
            let value = value.checked_mul(128)?;
            Some(value | usize::from(byte & 0x7F))
        };
        digits.try_fold(0, add)
    }

    /// Number of sets of attributes ("Parse Connectivity Data"), after the kind of traversal and the numbers of
    /// vertices and faces.
    fn num_attribute_sets(&mut self) -> Option<u64> {
        self.take(1)?;
        self.variable()?;
        self.variable()?;
        self.take(1).map(|sets| u64::from(sets[0]))
    }

    /// Skips the metadata of all attributes and of the geometry, and counts its entries.
    fn geometry_metadata(&mut self) -> Option<u64> {
        let num_attributes = self.variable()?;
        let mut num_entries = 0;
        for _ in 0..num_attributes {
            self.variable()?; // the number of the attribute
            num_entries += self.metadata(0)?;
        }
        Some(num_entries + self.metadata(0)?)
    }

    /// Skips one block of metadata, which may hold others, and counts its entries and itself.
    fn metadata(&mut self, depth: usize) -> Option<u64> {
        if depth > MOST_NESTED {
            return None;
        }
        let num_entries = self.variable()?;
        for _ in 0..num_entries {
            self.name()?;
            let length = self.variable()?;
            self.take(length)?;
        }
        let mut counted = 1 + num_entries as u64;
        for _ in 0..self.variable()? {
            self.name()?;
            counted += self.metadata(depth + 1)?;
        }
        Some(counted)
    }

    fn name(&mut self) -> Option<()> {
        let length = self.take(1)?[0];
        self.take(length.into()).map(|_| ())
    }
}
