//! Checks that an output file can be created.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::error::OutputError;
use reflet_base::files::{Goal, Inputs, Temporary, folder_of};
use reflet_render::runtime::scene_text::LoadedScene;

/// Checks that a file can be created, before rendering: it replaces a regular file or nothing, and none of the
/// `inputs`.
///
/// # Errors
/// [`OutputError::Usage`] with the invalid part of the path.
pub fn check_writable(path: &Goal, inputs: &Inputs) -> Result<(), OutputError> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(OutputError::Usage(format!(
            "--output {}: there is no folder {}; create it first: `mkdir -p {}`",
            path.display(),
            folder.display(),
            folder.display()
        )));
    }
    check_replaceable(path, inputs)?;
    // Only creating a file tests permissions reliably.
    Temporary::create(path).map(drop).map_err(|error| {
        OutputError::Usage(format!(
            "--output {}: cannot write to {}: {error}",
            path.display(),
            folder.display()
        ))
    })
}

/// Checks what is at the path of an output, but not whether its folder can be written to.
///
/// # Errors
/// [`OutputError::Usage`] for anything but a regular file or nothing, and for an input.
pub fn check_replaceable(path: &Goal, inputs: &Inputs) -> Result<(), OutputError> {
    let refuse = |error: io::Error| {
        let path = path.display();
        OutputError::Usage(format!("--output {path}: {error}; name another file"))
    };
    inputs.check(path).map_err(refuse)
}

/// Whether only the last folder of a file is missing.
pub fn lacks_last_folder(path: &Path) -> bool {
    let folder = folder_of(path);
    !folder.exists() && folder_of(folder).is_dir()
}

/// Creates the folder of a file if only that folder is missing; returns whether it did.
///
/// # Errors
/// [`OutputError::Usage`] for a folder that cannot be created.
pub fn create_last_folder(path: &Path) -> Result<bool, OutputError> {
    let folder = folder_of(path);
    if !lacks_last_folder(path) {
        return Ok(false);
    }
    match fs::create_dir(folder) {
        Ok(()) => Ok(true),
        // Another process that renders a part of the same film has created it meanwhile.
        Err(_) if folder.is_dir() => Ok(false),
        Err(error) => {
            let (shown, folder) = (path.display(), folder.display());
            let text = format!("--output {shown}: cannot create {folder}: {error}");
            Err(OutputError::Usage(text))
        }
    }
}

/// Files that a command on this scene reads, which none of its outputs may replace; `named` are files among its
/// arguments.
pub fn inputs<'a>(named: impl IntoIterator<Item = &'a Path>, loaded: &'a LoadedScene) -> Inputs {
    let read = loaded.world.files.iter().map(PathBuf::as_path);
    let project = loaded.project.iter().map(|project| project.file.as_path());
    Inputs::identify(read.chain(project).chain(named))
}
