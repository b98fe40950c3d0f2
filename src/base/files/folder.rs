//! A folder held open, in which files are made and renamed by name: on Unix no link leads elsewhere, even one that
//! takes the place of a folder meanwhile.

use std::{
    ffi::OsStr,
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

#[cfg(unix)]
use rustix::fs::{AtFlags, Mode, OFlags};

/// An open folder.
#[derive(Debug)]
pub(super) struct Folder {
    #[cfg(unix)]
    handle: File,
    /// Path by which it was opened.
    path: PathBuf,
}

impl Folder {
    /// Opens the folder of a path, through links.
    ///
    /// # Errors
    /// The system's error.
    pub fn open(path: &Path) -> io::Result<Self> {
        Ok(Self {
            #[cfg(unix)]
            handle: File::open(path)?,
            path: path.to_owned(),
        })
    }

    /// Opens a folder in this one, which must not be a link; with `makes` it is made if missing, which is returned too.
    ///
    /// # Errors
    /// The system's error, and a link.
    pub fn inner(&self, name: &OsStr, makes: bool) -> io::Result<(Self, bool)> {
        let path = self.path.join(name);
        let is_new = makes && fs::symlink_metadata(&path).is_err();
        if is_new && let Err(error) = self.make(name) {
            // Another process that renders a part of the same film may have made it meanwhile.
            path.is_dir().then_some(()).ok_or(error)?;
        }
        #[cfg(unix)]
        let opened = {
            let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::CLOEXEC;
            rustix::fs::openat(&self.handle, name, flags, Mode::empty())
        };
        #[cfg(unix)]
        let may_be_link = opened.is_err();
        #[cfg(not(unix))]
        let may_be_link = true;
        if may_be_link && path.is_symlink() {
            return Err(link(&format!("\"{}\"", path.display())));
        }
        let folder = Self {
            #[cfg(unix)]
            handle: opened?.into(),
            path,
        };
        Ok((folder, is_new))
    }

    /// Path by which the folder was opened.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Error of a link where none is followed.
pub(super) fn link(name: &str) -> io::Error {
    let message =
        format!("{name} is a link, and only a name that is typed as it stands may be one");
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

#[cfg(unix)]
impl Folder {
    fn make(&self, name: &OsStr) -> io::Result<()> {
        Ok(rustix::fs::mkdirat(&self.handle, name, Mode::from(0o777))?)
    }

    /// Creates a new file and opens it for writing; with `is_private` its owner alone may read it.
    ///
    /// # Errors
    /// The system's error; anything at its name.
    pub fn create(&self, name: &OsStr, is_private: bool) -> io::Result<File> {
        let flags = OFlags::WRONLY | OFlags::CREATE | OFlags::EXCL | OFlags::CLOEXEC;
        let mode = Mode::from(if is_private { 0o600 } else { 0o666 });
        Ok(rustix::fs::openat(&self.handle, name, flags, mode)?.into())
    }

    /// Removes a file, or a link itself.
    ///
    /// # Errors
    /// The system's error.
    pub fn remove(&self, name: &OsStr) -> io::Result<()> {
        Ok(rustix::fs::unlinkat(&self.handle, name, AtFlags::empty())?)
    }

    /// Gives a file another name, which replaces a file or a link itself there, and brings the name to the disk.
    ///
    /// # Errors
    /// The system's error.
    pub fn rename(&self, from: &OsStr, to: &OsStr) -> io::Result<()> {
        rustix::fs::renameat(&self.handle, from, &self.handle, to)?;
        self.handle.sync_all()
    }
}

/// Other systems open no file in a folder that is held; only the moment between the check and the write is left.
#[cfg(not(unix))]
impl Folder {
    fn make(&self, name: &OsStr) -> io::Result<()> {
        fs::create_dir(self.path.join(name))
    }

    pub fn create(&self, name: &OsStr, _: bool) -> io::Result<File> {
        File::create_new(self.path.join(name)) // files of a user's folder are private there
    }

    pub fn remove(&self, name: &OsStr) -> io::Result<()> {
        fs::remove_file(self.path.join(name))
    }

    pub fn rename(&self, from: &OsStr, to: &OsStr) -> io::Result<()> {
        fs::rename(self.path.join(from), self.path.join(to))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_held_folder_stays_where_it_was_opened() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let [inside, outside, moved] = ["in", "out", "moved"].map(|name| folder.join(name));
        fs::create_dir_all(&inside).expect("a folder");
        fs::create_dir(&outside).expect("a folder");
        let held = Folder::open(&inside).expect("opened");
        fs::rename(&inside, &moved).expect("renamed");
        symlink(&outside, &inside).expect("a link");
        let (deep, is_new) = held.inner(OsStr::new("deep"), true).expect("made");
        assert!(is_new);
        let name = OsStr::new("a.png");
        deep.create(name, false).expect("created");
        assert!(moved.join("deep/a.png").exists());
        assert_eq!(fs::read_dir(&outside).expect("readable").count(), 0);
        // Nothing is opened in place of a new file, nor made through a link.
        assert!(deep.create(name, false).is_err());
        symlink(outside.join("b.png"), moved.join("deep/b.png")).expect("a link");
        assert!(deep.create(OsStr::new("b.png"), false).is_err());
    }
}
