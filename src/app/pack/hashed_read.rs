//! Counts and hashes what is read through it.

use std::io::{self, Read};

use sha2::{Digest as _, Sha256};

use super::manifest::PackedFile;
use crate::files::hex;

/// A reader.
pub struct HashedRead<R> {
    from: R,
    bytes: u64,
    hash: Sha256,
}

impl<R: Read> HashedRead<R> {
    /// Nothing was read yet.
    pub fn new(from: R) -> Self {
        Self {
            from,
            bytes: 0,
            hash: Sha256::new(),
        }
    }

    /// What was read, as a file of that name in a pack.
    pub fn named(self, path: String) -> PackedFile {
        PackedFile {
            path,
            bytes: self.bytes,
            sha256: hex(&self.hash.finalize()),
        }
    }
}

impl<R: Read> Read for HashedRead<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.from.read(buffer)?;
        self.hash.update(&buffer[..length]);
        self.bytes += length as u64;
        Ok(length)
    }
}
