//! The search for the project of a scene, upward from its folder, as far as the same user decides what is there.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use reflet_base::files::in_memory;

use super::FILE;

/// File that marks a folder as unpacked from a pack: neither it nor the folders above it are searched.
pub const UNPACKED: &str = ".reflet-unpacked";

/// Facts that decide whether a folder may hold the project of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Facts {
    /// User who owns it.
    owner: u32,
    /// File system that it is on.
    device: u64,
    /// Whether all users may put files in it, as in `/tmp`.
    is_open: bool,
}

/// The file of the project of a scene in `folder`: the first [`FILE`] in it and the folders above. The search ends
/// before a folder with another owner, on another file system or that all users may write to, before the home folder
/// and the folder of temporary files, and at a folder that was unpacked. A file of another owner is no project.
pub fn find(folder: &Path) -> Option<PathBuf> {
    if cfg!(target_arch = "wasm32") {
        return in_memory::nearest(folder, FILE); // files of a page have no owners
    }
    let home = env::var_os("HOME").or_else(|| env::var_os("USERPROFILE"));
    let ends = [home.map(PathBuf::from), Some(env::temp_dir())];
    let ends = ends.into_iter().flatten();
    let ends: Vec<_> = ends.filter_map(|end| end.canonicalize().ok()).collect();
    find_by(&folder.canonicalize().ok()?, &ends, &facts)
}

fn find_by(
    folder: &Path,
    ends: &[PathBuf],
    facts: &dyn Fn(&Path) -> Option<Facts>,
) -> Option<PathBuf> {
    let own = facts(folder)?;
    for folder in folder.ancestors() {
        let here = facts(folder)?;
        let is_end = folder.parent().is_none() || ends.iter().any(|end| end == folder);
        if here != own
            || here.is_open
            || is_end
            || fs::symlink_metadata(folder.join(UNPACKED)).is_ok()
        {
            return None;
        }
        let file = folder.join(FILE);
        if facts(&file).is_some_and(|file| file.owner == own.owner && !file.is_open) {
            return Some(file);
        }
        // A link to nothing is reported, not passed over.
        if facts(&file).is_none() && fs::symlink_metadata(&file).is_ok() {
            return Some(file);
        }
    }
    None
}

/// Facts about a file or folder, links resolved.
#[cfg(unix)]
fn facts(path: &Path) -> Option<Facts> {
    use std::os::unix::fs::MetadataExt as _;
    let found = fs::metadata(path).ok()?;
    Some(Facts {
        owner: found.uid(),
        device: found.dev(),
        is_open: found.mode() & 0o002 != 0,
    })
}

/// Elsewhere the owner is unknown, so each folder counts as of another one, and only the scene's own is searched.
#[cfg(not(unix))]
fn facts(path: &Path) -> Option<Facts> {
    let _ = fs::metadata(path).ok()?;
    let folder = if path.is_dir() { path } else { path.parent()? };
    Some(Facts {
        owner: 0,
        device: folder.components().count() as u64,
        is_open: false,
    })
}

#[cfg(test)]
mod tests {
    use tempfile::TempDir;

    use super::*;

    /// Folders `a/b/c` with a project in `a`.
    struct Tree(TempDir);

    impl Tree {
        fn new() -> Self {
            let temporary = tempfile::tempdir().expect("writable");
            let folder = temporary.path();
            fs::create_dir_all(folder.join("a/b/c")).expect("writable");
            fs::write(folder.join("a").join(FILE), "").expect("writable");
            Self(temporary)
        }

        fn path(&self, path: &str) -> PathBuf {
            self.0.path().canonicalize().expect("there").join(path)
        }

        /// Search from `a/b/c` where one folder or file is different.
        fn search(&self, ends: &[PathBuf], other: &str, change: &dyn Fn(&mut Facts)) -> bool {
            let other = self.path(other);
            let facts = |path: &Path| {
                let mut found = facts(path)?;
                if path == other {
                    change(&mut found);
                }
                Some(found)
            };
            let found = find_by(&self.path("a/b/c"), ends, &facts);
            assert!(found.iter().all(|file| *file == self.path("a").join(FILE)));
            found.is_some()
        }
    }

    #[test]
    #[cfg(unix)]
    fn the_search_ends_where_another_user_may_decide() {
        let tree = Tree::new();
        let same = |_: &mut Facts| ();
        assert!(tree.search(&[], "", &same));
        let owner = |facts: &mut Facts| facts.owner += 1;
        let device = |facts: &mut Facts| facts.device += 1;
        let open = |facts: &mut Facts| facts.is_open = true;
        for folder in ["a", "a/b"] {
            assert!(!tree.search(&[], folder, &owner), "{folder}");
            assert!(!tree.search(&[], folder, &device), "{folder}");
            assert!(!tree.search(&[], folder, &open), "{folder}");
            assert!(
                !tree.search(&[tree.path(folder)], "", &same),
                "home is {folder}"
            );
        }
        // Above the project nothing matters.
        assert!(tree.search(&[tree.path("")], "", &owner));
        assert!(!tree.search(&[], "a/b/c", &open), "the scene's own folder");
        assert!(!tree.search(&[], "a/reflet.toml", &owner), "the file");
        assert!(!tree.search(&[], "a/reflet.toml", &open), "the file");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_is_a_project_that_cannot_be_read() {
        let tree = Tree::new();
        let file = tree.path("a/b").join(FILE);
        for target in ["nowhere.toml", FILE] {
            std::os::unix::fs::symlink(target, &file).expect("writable");
            assert_eq!(find(&tree.path("a/b/c")).as_ref(), Some(&file), "{target}");
            fs::remove_file(&file).expect("there");
        }
    }

    #[test]
    fn unpacked_folders_and_temporary_ones_hold_no_project() {
        let tree = Tree::new();
        for folder in ["a", "a/b"] {
            let mark = tree.path(folder).join(UNPACKED);
            fs::write(&mark, "").expect("writable");
            assert_eq!(find(&tree.path("a/b/c")), None, "{folder}");
            fs::remove_file(&mark).expect("there");
        }
        let above = env::temp_dir().join(FILE);
        assert_ne!(find(&tree.path("")), Some(above));
    }
}
