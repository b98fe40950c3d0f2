//! Checks that an output file can be created.

use std::{io, path::Path};

use crate::{
    app::error::AppError,
    files::{Inputs, Temporary, folder_of},
};

/// Checks that a file can be created, before rendering: it replaces a regular file or nothing, and none of the
/// `inputs`.
///
/// # Errors
/// [`AppError::Usage`] with the invalid part of the path.
pub fn check_writable(path: &Path, inputs: &Inputs) -> Result<(), AppError> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(AppError::Usage(format!(
            "--output {}: there is no folder {}; create it first",
            path.display(),
            folder.display()
        )));
    }
    check_replaceable(path, inputs)?;
    // Only creating a file tests permissions reliably.
    Temporary::create(path).map(drop).map_err(|error| {
        AppError::Usage(format!(
            "--output {}: cannot write to {}: {error}",
            path.display(),
            folder.display()
        ))
    })
}

/// Checks what is at the path of an output, but not whether its folder can be written to.
///
/// # Errors
/// [`AppError::Usage`] for anything but a regular file or nothing, and for an input.
pub fn check_replaceable(path: &Path, inputs: &Inputs) -> Result<(), AppError> {
    let refuse = |error: io::Error| {
        let path = path.display();
        AppError::Usage(format!("--output {path}: {error}; name another file"))
    };
    inputs.check(path).map_err(refuse)
}
