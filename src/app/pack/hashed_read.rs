//! Reader that counts and hashes the bytes read through it.

use std::io::{self, Read};

use sha2::{Digest as _, Sha256};

use super::manifest::PackedFile;
use crate::files::hex;

/// A reader with a byte count and a SHA-256 hash.
pub struct HashedRead<R> {
    from: R,
    bytes: u64,
    hash: Sha256,
}

impl<R: Read> HashedRead<R> {
    /// Wraps a reader of which nothing was read yet.
    pub fn new(from: R) -> Self {
        Self {
            from,
            bytes: 0,
            hash: Sha256::new(),
        }
    }

    /// Manifest entry of the bytes that were read, as a file of this name in a pack.
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
