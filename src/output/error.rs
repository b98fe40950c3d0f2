//! Errors of writing, denoising, and choosing frames and files.

use std::{io, path::Path};

/// Error of an output.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OutputError {
    /// A path, a frame list, a size or a rate that cannot be, or a library that is missing; begins with the option's
    /// name.
    #[error("{0}")]
    Usage(String),
    /// A full or read-only disk, or a failed video encoder: later files fail too.
    #[error("{0}")]
    Disk(String),
    /// Anything else.
    #[error("{0}")]
    Internal(String),
    /// The program was asked to stop while an encoder took nothing.
    #[error("stopped; no film was written")]
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
