//! Whether a file can be created where the command line says.

use std::{fs, io, path::Path};

use crate::{
    app::error::AppError,
    files::{Temporary, folder_of},
};

/// Checks that a file can be created, before any time is spent on rendering it.
///
/// # Errors
/// [`AppError::Usage`] saying which part of the path is wrong.
pub fn check_writable(path: &Path) -> Result<(), AppError> {
    let shown = path.display();
    let usage = |text: String| Err(AppError::Usage(text));
    if path.is_dir() {
        return usage(format!("--output {shown}: is a folder"));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return usage(format!(
            "--output {shown}: there is no folder {}; create it first",
            folder.display()
        ));
    }
    // The hidden name that files are written under may be shorter than this one.
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return usage(format!("--output {shown}: {error}"));
        }
        _ => {}
    }
    // Creating a file is the only test of permissions that means anything.
    if let Err(error) = Temporary::create(path) {
        return usage(format!(
            "--output {shown}: cannot write to {}: {error}",
            folder.display()
        ));
    }
    Ok(())
}
