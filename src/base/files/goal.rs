//! Rules for the target path of an output: it is a regular file or nothing, and no input of the same run.

use std::{
    collections::HashSet,
    ffi::OsString,
    fs, io,
    ops::Deref,
    path::{Component, Path, PathBuf},
};

use super::{
    folder::{Folder, link},
    folder_of,
};

/// Target path of an output, and how far links lead it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Goal {
    path: PathBuf,
    /// Folder below which no part of the path may be a link; none for a path that was typed.
    border: Option<PathBuf>,
}

impl Goal {
    /// Path that the user typed as it stands. Links are followed: an output replaces the file behind one.
    pub const fn typed(path: PathBuf) -> Self {
        Self { path, border: None }
    }

    /// Path with parts that a scene, a project or this program named: they are below the folder `border`, and none of
    /// them may be a link.
    pub fn within(border: &Path, path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            border: Some(border.to_owned()),
        }
    }

    /// Path of a folder that the user typed and a name in it that this program gave.
    pub fn in_folder(path: impl Into<PathBuf>) -> Self {
        let path = path.into();
        Self::within(folder_of(&path), path.clone())
    }

    /// Another path for this one, such as a frame's: parts that were not typed may be no links.
    pub fn renamed(&self, path: PathBuf) -> Self {
        let same = || {
            let parts = self.path.components().zip(path.components());
            let same = parts.take_while(|(typed, part)| typed == part);
            same.map(|(_, part)| part).collect()
        };
        let border = match path == self.path {
            true => self.border.clone(),
            false => self.border.clone().or_else(|| Some(same())),
        };
        Self { path, border }
    }

    /// Makes the missing folders of the path below its border, and returns their paths.
    ///
    /// # Errors
    /// The system's error, and a link below the border.
    pub fn make_folders(&self) -> io::Result<Vec<PathBuf>> {
        let mut made = Vec::new();
        self.walk(Some(&mut made))?;
        Ok(made)
    }

    /// Folder of the target, held open, and the target's name in it.
    ///
    /// # Errors
    /// The system's error, a path without a name, and a link below the border.
    pub(super) fn opened(&self) -> io::Result<(Folder, OsString)> {
        self.walk(None)
    }

    fn walk(&self, mut made: Option<&mut Vec<PathBuf>>) -> io::Result<(Folder, OsString)> {
        let wrong = |message| io::Error::new(io::ErrorKind::InvalidInput, message);
        let path = match self.border {
            Some(_) => self.path.clone(),
            None => resolved(&self.path),
        };
        let name = path.file_name().ok_or(wrong("the path has no file name"))?;
        let parent = path.parent().unwrap_or(Path::new(""));
        let border = self.border.as_deref().unwrap_or(parent);
        let inner = parent.strip_prefix(border);
        let is_here = border.as_os_str().is_empty();
        let mut folder = Folder::open(if is_here { Path::new(".") } else { border })?;
        for part in inner
            .map_err(|_| wrong("it leads out of its folder"))?
            .components()
        {
            let Component::Normal(part) = part else {
                return Err(wrong("it leads out of its folder"));
            };
            let (inside, is_new) = folder.inner(part, made.is_some())?;
            folder = inside;
            if let (true, Some(made)) = (is_new, &mut made) {
                made.push(folder.path().to_owned());
            }
        }
        Ok((folder, name.to_owned()))
    }

    /// Refuses a target at which there is anything but a regular file that may be written, or nothing; below a border,
    /// also a link.
    ///
    /// # Errors
    /// Kind of the object at a path, as a clause such as "it is a device", or the error of the system.
    pub fn check(&self) -> io::Result<()> {
        let found = match fs::metadata(&self.path) {
            _ if self.border.is_some() && self.path.is_symlink() => return Err(link("it")),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return match self.path.is_symlink() {
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
}

impl Deref for Goal {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

/// Path on the command line.
impl From<OsString> for Goal {
    fn from(path: OsString) -> Self {
        Self::typed(path.into())
    }
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
fn resolved(goal: &Path) -> PathBuf {
    let linked = goal.is_symlink().then(|| fs::canonicalize(goal).ok());
    linked.flatten().unwrap_or_else(|| goal.to_owned())
}

/// Files that a run reads, which none of its outputs may replace. Their identity counts, not their names: links, `..`
/// and hard links lead to the same file.
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
    pub fn identify(paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        let paths = paths.into_iter();
        Self(paths.flat_map(|path| identities(path.as_ref())).collect())
    }

    /// Whether a path leads to one of the files.
    pub fn hold(&self, path: &Path) -> bool {
        identities(path).iter().any(|found| self.0.contains(found))
    }

    /// Refuses a target as [`Goal::check`] does, and one that leads to one of the files.
    ///
    /// # Errors
    /// Same errors as [`Goal::check`], and an input at the path.
    pub fn check(&self, goal: &Goal) -> io::Result<()> {
        goal.check()?;
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
    use crate::files::{open_regular, write_whole};

    #[cfg(unix)]
    #[test]
    fn only_regular_files_are_replaced() {
        use std::os::unix::{fs::symlink, net::UnixListener};
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
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
            let entries = fs::read_dir(folder).expect("readable").flatten();
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
            let error = write_whole(&Goal::typed(path(name)), b"new").expect_err(name);
            assert!(error.to_string().contains(says), "{name}: {error}");
        }
        assert_eq!(names(), before, "nothing is left behind");
        assert_eq!(fs::read(path("locked")).expect("there"), b"old");
    }

    #[cfg(unix)]
    #[test]
    fn an_output_through_a_link_replaces_the_linked_file() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        fs::create_dir(folder.join("inside")).expect("a folder");
        fs::write(folder.join("inside/real"), "old").expect("written");
        std::os::unix::fs::symlink("inside/real", folder.join("link")).expect("a link");
        assert!(open_regular(&folder.join("link"), false).is_ok());
        assert!(open_regular(&folder.join("link"), true).is_err());
        write_whole(&Goal::typed(folder.join("link")), b"new").expect("written");
        assert!(folder.join("link").is_symlink());
        assert_eq!(fs::read(folder.join("inside/real")).expect("there"), b"new");
        assert_eq!(fs::read_dir(folder).expect("readable").count(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_appears_after_the_check_is_not_followed() {
        use crate::files::Temporary;
        use std::os::unix::fs::symlink;
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let [inside, outside, moved] = ["in", "out", "moved"].map(|name| folder.join(name));
        let goal = Goal::within(folder, inside.join("deep/a.png"));
        assert_eq!(goal.make_folders().expect("made").len(), 2);
        fs::create_dir(&outside).expect("a folder");
        fs::write(outside.join("a.png"), "precious").expect("written");
        let link_name = || symlink(outside.join("a.png"), inside.join("deep/a.png"));
        let link_folder = || {
            fs::rename(inside.join("deep"), &moved)?;
            symlink(&outside, inside.join("deep"))
        };
        let swaps: [&dyn Fn() -> io::Result<()>; 2] = [&link_name, &link_folder];
        for swap in swaps {
            let temporary = Temporary::create(&goal).and_then(|file| file.fill(b"new"));
            swap().expect("swapped");
            // Where the link takes the place of the target, it is the name that is replaced.
            let found = goal.opened().ok();
            assert!(found.is_none_or(|(folder, _)| folder.path() == inside.join("deep")));
            let renamed = temporary.and_then(Temporary::persist);
            renamed.expect("written into the folder that was opened");
            assert!(!inside.join("deep/a.png").is_symlink());
            assert_eq!(fs::read(outside.join("a.png")).expect("there"), b"precious");
            assert_eq!(fs::read_dir(&outside).expect("readable").count(), 1);
        }
        assert_eq!(fs::read(moved.join("a.png")).expect("there"), b"new");
        let said = write_whole(&goal, b"new").expect_err("a link").to_string();
        assert!(said.contains("deep\" is a link"), "{said}");
        assert!(goal.make_folders().is_err());
        let climbs = Goal::within(&inside, inside.join("../out/a.png"));
        assert!(write_whole(&climbs, b"new").is_err());
    }

    #[test]
    fn a_typed_pattern_lends_no_trust_to_its_names() {
        let typed = Goal::typed("a/b/{camera}.png".into());
        assert_eq!(typed.renamed("a/b/{camera}.png".into()), typed);
        let named = typed.renamed("a/b/c.png".into());
        assert_eq!(named, Goal::within(Path::new("a/b"), "a/b/c.png"));
        assert_eq!(named.renamed("a/b/c.1.png".into()).border, named.border);
        let here = Goal::typed("c.png".into()).renamed("c.depth.png".into());
        assert_eq!(here.border.as_deref(), Some(Path::new("")));
    }

    #[cfg(unix)]
    #[test]
    fn inputs_are_known_by_any_name() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let path = |name: &str| folder.join(name);
        fs::create_dir(path("inside")).expect("a folder");
        for name in ["scene", "other"] {
            fs::write(path(name), "same").expect("written");
        }
        fs::hard_link(path("scene"), path("hard")).expect("a hard link");
        std::os::unix::fs::symlink("scene", path("soft")).expect("a link");
        let inputs = Inputs::identify([path("scene"), path("missing")]);
        for name in ["scene", "inside/../scene", "hard", "soft"] {
            assert!(inputs.check(&Goal::typed(path(name))).is_err(), "{name}");
        }
        for name in ["other", "missing", "new"] {
            assert!(inputs.check(&Goal::typed(path(name))).is_ok(), "{name}");
        }
    }
}
