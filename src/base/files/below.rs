//! Files and folders below a folder.

use std::path::Path;

#[cfg(target_arch = "wasm32")]
pub use super::in_memory::{DirEntry, entries_below};
#[cfg(not(target_arch = "wasm32"))]
use walkdir::{DirEntry, WalkDir};

/// Entries below a folder, by name, without hidden and unreadable entries: to `depth` folders below it, and through
/// links where `follows_links`.
#[cfg(not(target_arch = "wasm32"))]
pub fn entries_below(
    folder: &Path,
    depth: usize,
    follows_links: bool,
) -> impl Iterator<Item = DirEntry> {
    let is_hidden = |entry: &DirEntry| entry.file_name().as_encoded_bytes().starts_with(b".");
    let walk = WalkDir::new(folder).min_depth(1).max_depth(depth + 1);
    let walk = walk.follow_links(follows_links).sort_by_file_name();
    let shown = walk
        .into_iter()
        .filter_entry(move |entry| !is_hidden(entry));
    shown.filter_map(Result::ok)
}

/// Whether the name of an entry ends with any of these extensions, in capitals too.
pub fn has_extension(entry: &DirEntry, extensions: &[&str]) -> bool {
    let own = entry.path().extension().and_then(|own| own.to_str());
    own.is_some_and(|own| {
        extensions
            .iter()
            .any(|known| own.eq_ignore_ascii_case(known))
    })
}

/// Path of an entry from a folder above it, with slashes; `None` for names that are no text.
pub fn path_below(entry: &DirEntry, folder: &Path) -> Option<String> {
    let path = entry.path().strip_prefix(folder).ok()?;
    let parts: Option<Vec<_>> = path.iter().map(|part| part.to_str()).collect();
    Some(parts?.join("/"))
}
