//! Errors of writing, denoising, and choosing frames and files.

use std::{fmt, io, path::Path};

/// Error of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OutputError {
    /// A path, a frame list, a size or a rate that cannot be, or a library that is missing; begins with the option's
    /// name.
    Usage(String),
    /// A full or read-only disk, or a failed video encoder: later files fail too.
    Disk(String),
    /// Anything else.
    Internal(String),
    /// The program was asked to stop while an encoder took nothing.
    Stopped,
}

impl OutputError {
    /// A file that cannot be written; a full disk is fatal for all others too.
    pub fn unwritten(path: &Path, error: &io::Error) -> Self {
        use io::ErrorKind::{QuotaExceeded, ReadOnlyFilesystem, StorageFull};
        let text = format!("cannot write {}: {error}", path.display());
        match error.kind() {
            StorageFull | QuotaExceeded | ReadOnlyFilesystem => Self::Disk(text),
            _ => Self::Internal(text),
        }
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Usage(text) | Self::Disk(text) | Self::Internal(text) => text,
            Self::Stopped => "stopped; no film was written",
        })
    }
}

impl std::error::Error for OutputError {}
