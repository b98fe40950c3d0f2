//! The folders of shaders, for the library, for the watch on its files, and for the build script that embeds them.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Folders of shaders below a root, which need not exist: for passes the root and each `methods/NAME/`, for libraries
/// the `lib/` of each of these.
pub fn shader_folders(root: &Path) -> Vec<PathBuf> {
    let methods = fs::read_dir(root.join("methods")).into_iter().flatten();
    let mut rooms: Vec<_> = methods.flatten().map(|entry| entry.path()).collect();
    rooms.sort();
    rooms.insert(0, root.to_owned());
    rooms
        .into_iter()
        .flat_map(|room| [room.join("lib"), room])
        .collect()
}
