//! Checks that an output file can be created.

use std::{fs, io, path::Path};

use crate::{
    app::error::AppError,
    files::{Temporary, folder_of},
};

/// Checks that a file can be created, before rendering.
///
/// # Errors
/// [`AppError::Usage`] with the invalid part of the path.
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
    // The temporary name may be shorter than this one.
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return usage(format!("--output {shown}: {error}"));
        }
        _ => {}
    }
    // Only creating a file tests permissions reliably.
    if let Err(error) = Temporary::create(path) {
        return usage(format!(
            "--output {shown}: cannot write to {}: {error}",
            folder.display()
        ));
    }
    Ok(())
}
