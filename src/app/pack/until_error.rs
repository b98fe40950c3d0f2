//! A file that is written until its first error, as on a full disk.

use std::{
    cell::RefCell,
    fs::File,
    io::{self, Seek, SeekFrom, Write},
};

/// Writes and seeks until an error, which it keeps, and then writes nothing more: the library would print words of its
/// own when it is dropped.
pub struct UntilError<'a> {
    /// The file.
    pub file: &'a File,
    /// The first error.
    pub error: &'a RefCell<Option<io::Error>>,
}

impl Write for UntilError<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.error.borrow().is_none() {
            match self.file.write(bytes) {
                Err(error) if error.kind() != io::ErrorKind::Interrupted => {
                    self.error.replace(Some(error));
                }
                written => return written,
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for UntilError<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}
