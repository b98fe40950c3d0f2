//! Manifest at the end of a pack: its files with their hashes, and how they are rendered.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

/// Name of the manifest in the pack.
pub const LIST: &str = "pack.json";

/// Hash of the program's source and shaders, from `build.rs`.
pub const BUILT_FROM: &str = env!("REFLET_BUILT_FROM");

/// Largest manifest that is read, bytes: about a hundred thousand files.
pub const MOST_BYTES: u64 = 32 << 20;

/// Manifest of a pack.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    /// First and last frame; none for one picture.
    pub frames: Option<[u32; 2]>,
    /// Every file but the manifest, by name.
    pub files: Vec<PackedFile>,
}

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
        let folder = self
            .assets
            .iter()
            .find(|f| !f.is_empty() && fault_of_name(f).is_some());
        folder.map(|f| format!("the folder \"{}\" of assets is refused", f.escape_debug()))
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
    fn names_that_leave_the_folder_are_faults() {
        for name in ["a.toml", "a/b c/d..e.glb", "..a", "ü/日.toml"] {
            assert_eq!(fault_of_name(name), None, "{name}");
        }
        for name in [
            "",
            "/a",
            "../a",
            "a/../../b",
            "a//b",
            "a/",
            "./a",
            "C:a",
            "a\\..\\b",
            "a\0",
        ] {
            assert!(fault_of_name(name).is_some(), "{name}");
        }
    }
}
