//! Manifest at the end of a pack: its files with their hashes, and how they are rendered.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use reflet_scene::project::UNPACKED;

/// Name of the manifest in the pack.
pub const LIST: &str = "pack.json";

/// Largest manifest that is read, bytes: about a hundred thousand files.
pub const MOST_BYTES: u64 = 32 << 20;

/// Manifest of a pack.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of this format: 1.
    pub pack: u32,
    /// Version of the Reflet that wrote the pack.
    pub reflet: String,
    /// Hash of that program's source: another build may render other pictures.
    pub built_from: String,
    /// Name of the scene in the pack.
    pub scene: String,
    /// Names of the `--assets` folders in the pack; the empty name is its top.
    pub assets: Vec<String>,
    /// Values of `--set`, in order.
    pub set: Vec<String>,
    /// Values of `--variant`, in order.
    pub variant: Vec<String>,
    /// Whether `--lenient` was given.
    pub lenient: bool,
    /// Whether `--strict` was given.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub strict: bool,
    /// Name of the project's folder in the pack; the empty name is its top, none is no project.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<String>,
    /// First and last frame; none for one picture.
    pub frames: Option<[u32; 2]>,
    /// Every file but the manifest, by name.
    pub files: Vec<PackedFile>,
}

/// Factor by which the files of a pack may be longer than the pack: no files of a scene compress better.
const MOST_RATIO: u64 = 200;

/// Total length up to which files may compress to anything, bytes.
const FREE_RATIO_BYTES: u64 = 1 << 30;

/// Space on the disk that a file may take beyond its length, bytes.
const BLOCK_BYTES: u64 = 4 << 10;

/// A file of a pack.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PackedFile {
    /// Name in the pack, with `/` between its parts.
    pub path: String,
    /// Length of the file, bytes.
    pub bytes: u64,
    /// SHA-256 of the content, hexadecimal.
    pub sha256: String,
}

impl Manifest {
    /// Manifest of a scene that is rendered as it is, without files; `built_from` is the hash of this program's source.
    pub fn new(scene: String, built_from: &str) -> Self {
        Self {
            pack: 1,
            reflet: env!("CARGO_PKG_VERSION").to_owned(),
            built_from: built_from.to_owned(),
            scene,
            ..Self::default()
        }
    }

    /// Error in the manifest, if there is one: a name that leaves the folder, a duplicate name, or a missing
    /// scene.
    pub fn fault(&self) -> Option<String> {
        if self.pack != 1 {
            let version = self.pack;
            return Some(format!(
                "it is of version {version}; this Reflet reads version 1"
            ));
        }
        let mut names = BTreeSet::new();
        for file in &self.files {
            let name = &file.path;
            if let Some(why) = fault_of_name(name) {
                return Some(format!(
                    "the name \"{}\" is refused: {why}",
                    name.escape_debug()
                ));
            }
            if name == UNPACKED {
                return Some(format!(
                    "a file is named {UNPACKED}, as the mark of unpacked folders"
                ));
            }
            if name == LIST || !names.insert(name.as_str()) {
                return Some(format!("two files are named \"{name}\""));
            }
        }
        if !names.contains(self.scene.as_str()) {
            return Some(format!(
                "its scene, \"{}\", is missing",
                self.scene.escape_debug()
            ));
        }
        let folder = (self.assets.iter())
            .chain(&self.project)
            .find(|f| !f.is_empty() && fault_of_name(f).is_some());
        folder.map(|f| format!("the folder \"{}\" is refused", f.escape_debug()))
    }

    /// Reason why files of these lengths are refused in a pack of `pack_bytes`, if there is one: it is most likely
    /// made to fill disks.
    pub fn fault_of_size(&self, pack_bytes: u64) -> Option<String> {
        let total = self.total_bytes();
        let most = pack_bytes.saturating_mul(MOST_RATIO).max(FREE_RATIO_BYTES);
        (total > most).then(|| {
            format!(
                "its files are {total} bytes long, more than {MOST_RATIO} times its own {pack_bytes}"
            )
        })
    }

    /// Total length of the files, bytes.
    pub fn total_bytes(&self) -> u64 {
        let lengths = self.files.iter().map(|file| file.bytes);
        lengths.fold(0, u64::saturating_add)
    }

    /// Space on the disk that the files need, bytes.
    pub fn disk_bytes(&self) -> u64 {
        let blocks = BLOCK_BYTES.saturating_mul(self.files.len() as u64);
        self.total_bytes().saturating_add(blocks)
    }
}

/// Reason why a name is refused in a pack: it must lead to the same place below a folder on every system.
pub fn fault_of_name(name: &str) -> Option<&'static str> {
    if name.contains(['\\', ':']) || name.chars().any(char::is_control) {
        return Some("a backslash, a colon or a control character means something else elsewhere");
    }
    match name.split('/').find(|part| ["", ".", ".."].contains(part)) {
        Some("..") => Some("it leaves the pack's folder"),
        Some(_) => Some("a part of it is empty or a dot"),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_far_longer_than_their_pack_are_a_fault() {
        let pack_of = |lengths: &[u64]| Manifest {
            files: (lengths.iter().enumerate())
                .map(|(index, bytes)| PackedFile {
                    path: index.to_string(),
                    bytes: *bytes,
                    sha256: String::new(),
                })
                .collect(),
            ..Manifest::default()
        };
        let gib = 1 << 30;
        assert_eq!(pack_of(&[gib]).fault_of_size(1000), None);
        assert!(pack_of(&[gib, 1]).fault_of_size(1000).is_some());
        assert_eq!(pack_of(&[gib, gib]).fault_of_size(gib / 50), None);
        assert!(pack_of(&[u64::MAX; 2]).fault_of_size(gib).is_some());
    }

    #[test]
    fn names_that_leave_the_folder_are_faults() {
        for name in ["a.toml", "a/b c/d..e.glb", "..a", "ü/日.toml"] {
            assert_eq!(fault_of_name(name), None, "{name}");
        }
        for name in " /a ../a a/../../b a//b a/ ./a C:a a\\..\\b a\0".split(' ') {
            assert!(fault_of_name(name).is_some(), "{name}");
        }
    }
}
