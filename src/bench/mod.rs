//! Judging pictures: metrics, the reading and writing they need, and the command `compare`.
//!
//! `metric` is pure (pictures in, numbers out); only `read` and `write` touch files.

pub mod compare;
pub mod metric;
pub mod picture;
pub mod read;
pub mod report;
pub mod write;

use std::path::Path;

use crate::scene::diagnostic::Diagnostic;

/// An error about the file `file`, with what to do about it.
fn file_error(
    name: &'static str,
    file: &Path,
    message: impl Into<String>,
    help: impl Into<String>,
) -> Box<Diagnostic> {
    Box::new(Diagnostic {
        help: Some(help.into()),
        ..Diagnostic::in_file(name, file, message)
    })
}
