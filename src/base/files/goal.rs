//! Rules for the target path of an output: it is a regular file or nothing, and no input of the same run.

use std::{
    collections::HashSet,
    fs, io,
    path::{Path, PathBuf},
};

/// Refuses a target path at which there is anything but a regular file that may be written, or nothing. A link is
/// followed: its file is what an output replaces.
///
/// # Errors
/// Kind of the object at a path, as a clause such as "it is a device", or the error of the system.
pub fn check_goal(goal: &Path) -> io::Result<()> {
    let found = match fs::metadata(goal) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return match goal.is_symlink() {
                true => refuse("it is a link to a file that does not exist"),
                false => Ok(()),
            };
        }
        found => found?,
    };
    if found.is_dir() {
        let message = "it is a folder";
        return Err(io::Error::new(io::ErrorKind::IsADirectory, message));
    }
    if !found.is_file() {
        return refuse(special_kind(found.file_type()));
    }
    if found.permissions().readonly() {
        let message = "it is read-only";
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, message));
    }
    Ok(())
}

fn refuse(message: &str) -> io::Result<()> {
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}

/// Clause for a file that is neither regular nor a folder.
fn special_kind(kind: fs::FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        if kind.is_fifo() {
            return "it is a pipe";
        }
        if kind.is_socket() {
            return "it is a socket";
        }
        if kind.is_char_device() || kind.is_block_device() {
            return "it is a device";
        }
    }
    let _ = kind; // other systems do not tell more
    "it is not a regular file"
}

/// Target path with a link at its end followed.
pub(super) fn resolved(goal: &Path) -> PathBuf {
    let linked = goal.is_symlink().then(|| fs::canonicalize(goal).ok());
    linked.flatten().unwrap_or_else(|| goal.to_owned())
}

/// Files that a run reads, which none of its outputs may replace. They are told apart by what they are, not by their
/// names: links, `..` and hard links lead to the same file.
#[derive(Clone, Debug, Default)]
pub struct Inputs(HashSet<Identity>);

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Identity {
    /// Numbers of device and inode.
    #[cfg(unix)]
    Inode([u64; 2]),
    /// Path without links.
    Path(PathBuf),
}

impl Inputs {
    /// Set of these files, as they are on the disk now; a file that does not exist is left out.
    pub fn of(paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        let paths = paths.into_iter();
        Self(paths.flat_map(|path| identities(path.as_ref())).collect())
    }

    /// Whether a path leads to one of the files.
    pub fn hold(&self, path: &Path) -> bool {
        identities(path).iter().any(|found| self.0.contains(found))
    }

    /// Refuses a target path as [`check_goal`] does, and one that leads to one of the files.
    ///
    /// # Errors
    /// Same errors as [`check_goal`], and an input at the path.
    pub fn check(&self, goal: &Path) -> io::Result<()> {
        check_goal(goal)?;
        match self.hold(goal) {
            true => refuse("it is an input of this command, which would be lost"),
            false => Ok(()),
        }
    }
}

fn identities(path: &Path) -> Vec<Identity> {
    let path_of = fs::canonicalize(path).ok().map(Identity::Path);
    path_of.into_iter().chain(inode(path)).collect()
}

#[cfg(unix)]
fn inode(path: &Path) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt as _;
    let metadata = fs::metadata(path).ok()?;
    Some(Identity::Inode([metadata.dev(), metadata.ino()]))
}

/// Numbers of a file that the standard library tells on Unix alone.
#[cfg(not(unix))]
fn inode(_: &Path) -> Option<Identity> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::write_whole;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("reflet-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_replaced() {
        use std::os::unix::{fs::symlink, net::UnixListener};
        let folder = folder("goals");
        let path = |name: &str| folder.join(name);
        fs::create_dir(path("folder")).expect("a folder");
        let _socket = UnixListener::bind(path("socket")).expect("a socket");
        let made = std::process::Command::new("mkfifo")
            .arg(path("pipe"))
            .status();
        assert!(made.is_ok_and(|status| status.success()));
        fs::write(path("locked"), "old").expect("written");
        let mut locked = fs::metadata(path("locked")).expect("there").permissions();
        locked.set_readonly(true);
        fs::set_permissions(path("locked"), locked).expect("settable");
        symlink("nowhere", path("dangling")).expect("a link");
        symlink("/dev/null", path("null")).expect("a link");
        symlink("locked", path("to-locked")).expect("a link");
        let names = || {
            let entries = fs::read_dir(&folder).expect("readable").flatten();
            let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
            names.sort();
            names
        };
        let before = names();
        for (name, says) in [
            ("folder", "a folder"),
            ("socket", "a socket"),
            ("pipe", "a pipe"),
            ("locked", "read-only"),
            ("dangling", "a link"),
            ("null", "a device"),
            ("to-locked", "read-only"),
        ] {
            let error = write_whole(&path(name), b"new").expect_err(name);
            assert!(error.to_string().contains(says), "{name}: {error}");
        }
        assert_eq!(names(), before, "nothing is left behind");
        assert_eq!(fs::read(path("locked")).expect("there"), b"old");
        fs::remove_dir_all(&folder).expect("clean up");
    }

    #[cfg(unix)]
    #[test]
    fn an_output_through_a_link_replaces_the_linked_file() {
        let folder = folder("linked");
        fs::create_dir(folder.join("inside")).expect("a folder");
        fs::write(folder.join("inside/real"), "old").expect("written");
        std::os::unix::fs::symlink("inside/real", folder.join("link")).expect("a link");
        write_whole(&folder.join("link"), b"new").expect("written");
        assert!(folder.join("link").is_symlink());
        assert_eq!(fs::read(folder.join("inside/real")).expect("there"), b"new");
        assert_eq!(fs::read_dir(&folder).expect("readable").count(), 2);
        fs::remove_dir_all(&folder).expect("clean up");
    }

    #[cfg(unix)]
    #[test]
    fn inputs_are_known_by_any_name() {
        let folder = folder("inputs");
        let path = |name: &str| folder.join(name);
        fs::create_dir(path("inside")).expect("a folder");
        for name in ["scene", "other"] {
            fs::write(path(name), "same").expect("written");
        }
        fs::hard_link(path("scene"), path("hard")).expect("a hard link");
        std::os::unix::fs::symlink("scene", path("soft")).expect("a link");
        let inputs = Inputs::of([path("scene"), path("missing")]);
        for name in ["scene", "inside/../scene", "hard", "soft"] {
            assert!(inputs.check(&path(name)).is_err(), "{name}");
        }
        for name in ["other", "missing", "new"] {
            assert!(inputs.check(&path(name)).is_ok(), "{name}");
        }
        fs::remove_dir_all(&folder).expect("clean up");
    }
}
