//! A folder that gets its name once it is complete.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use crate::files::{hidden_path, sync_name};

/// A folder under a hidden name beside its target path; deleted on drop unless it was renamed. Leftovers of a killed
/// run are deleted by [`crate::files::sweep`].
pub struct Unfinished {
    goal: PathBuf,
    folder: PathBuf,
    renamed: bool,
}

impl Unfinished {
    /// Creates the folder beside the target path `goal`.
    ///
    /// # Errors
    /// The system's error.
    pub fn create(goal: &Path) -> io::Result<Self> {
        let folder = hidden_path(goal);
        // A leftover of a killed run may have this name.
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder)?;
        Ok(Self {
            goal: goal.to_owned(),
            folder,
            renamed: false,
        })
    }

    /// Path of the folder until it is renamed.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// Brings all files to the disk and renames the folder to its target path.
    ///
    /// # Errors
    /// The system's error.
    pub fn persist(mut self) -> io::Result<()> {
        sync(&self.folder)?;
        fs::rename(&self.folder, &self.goal)?;
        self.renamed = true;
        sync_name(&self.goal)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.renamed {
            // Errors cannot be returned from `drop`, and the next run deletes the folder.
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

/// Brings all files below a folder to the disk: by one call for their file system.
#[cfg(target_os = "linux")]
fn sync(folder: &Path) -> io::Result<()> {
    Ok(rustix::fs::syncfs(File::open(folder)?)?)
}

/// Brings all files below a folder to the disk, each by its own call.
#[cfg(not(target_os = "linux"))]
fn sync(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        match entry.file_type()?.is_dir() {
            true => sync(&entry.path())?,
            false => File::options().write(true).open(entry.path())?.sync_all()?,
        }
    }
    Ok(())
}
