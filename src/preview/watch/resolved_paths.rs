//! Symbolic link resolution: a file's own path and the links to it.

use std::{
    fs,
    path::{Component, Path, PathBuf},
};

/// Maximum number of chained links; as in Linux.
const MOST_LINKS: u32 = 40;

/// The path without links, or at least absolute.
pub fn canonical(path: &Path) -> PathBuf {
    path.canonicalize()
        .or_else(|_| std::path::absolute(path))
        .unwrap_or_else(|_| path.to_owned())
}

/// The file's own path and the paths of links to it, each in a folder without links.
pub fn resolved_paths(name: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut rest = std::path::absolute(name).unwrap_or_else(|_| name.to_owned());
    for _ in 0..MOST_LINKS {
        let Some((link, after)) = first_link(&rest) else {
            found.push(rest);
            return found;
        };
        let target = fs::read_link(&link).unwrap_or_default();
        let folder = link.parent().unwrap_or(Path::new("/"));
        rest = folder.join(target).join(after);
        found.push(link);
    }
    found
}

/// The first link of an absolute path, and the rest of the path.
fn first_link(path: &Path) -> Option<(PathBuf, PathBuf)> {
    let mut before = PathBuf::new();
    let mut parts = path.components();
    while let Some(part) = parts.next() {
        match part {
            Component::ParentDir => {
                before.pop();
            }
            Component::CurDir => {}
            part => before.push(part),
        }
        if before.is_symlink() {
            return Some((before, parts.as_path().to_owned()));
        }
    }
    None
}
