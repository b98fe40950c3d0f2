//! Files that are there whole or not at all.

use std::{
    ffi::OsString,
    fs::{self, File, OpenOptions},
    io::Write as _,
    path::{Path, PathBuf},
};

use super::error::AppError;

/// A file under a hidden name beside its goal; gone unless it is renamed.
pub struct Temporary {
    path: PathBuf,
    /// Where to write.
    pub file: File,
    renamed: bool,
}

impl Temporary {
    /// Creates it beside `goal`.
    ///
    /// # Errors
    /// What the system says.
    pub fn create(goal: &Path) -> std::io::Result<Self> {
        let mut name = OsString::from(".");
        name.push(goal.file_name().unwrap_or_default());
        name.push(format!(".{}.tmp", std::process::id()));
        let path = folder_of(goal).join(name);
        // A leftover of a killed run may have this name; `create_new` never follows a link.
        let _ = fs::remove_file(&path);
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)?;
        Ok(Self {
            path,
            file,
            renamed: false,
        })
    }

    /// Writes all of it, to the disk.
    ///
    /// # Errors
    /// What the system says.
    pub fn fill(mut self, bytes: &[u8]) -> std::io::Result<Self> {
        self.file.write_all(bytes)?;
        self.file.sync_all()?;
        Ok(self)
    }

    /// Gives it its name.
    ///
    /// # Errors
    /// What the system says.
    pub fn rename_to(mut self, goal: &Path) -> std::io::Result<()> {
        fs::rename(&self.path, goal)?;
        self.renamed = true;
        // The new name itself must survive a crash too; only Unix can sync a folder.
        if cfg!(unix) {
            File::open(folder_of(goal))?.sync_all()?;
        }
        Ok(())
    }
}

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
    // Creating a file is the only test of permissions that means anything.
    if let Err(error) = Temporary::create(path) {
        return usage(format!(
            "--output {shown}: cannot write to {}: {error}",
            folder.display()
        ));
    }
    Ok(())
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // Nobody is left to tell, and the next run overwrites it.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The folder that a file stands in.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

impl Temporary {
    /// Where it is until it is renamed.
    pub fn path(&self) -> &Path {
        &self.path
    }
}
