//! Cache record of a conversion, and its validation.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    time::SystemTime,
};

use serde::{Deserialize, Serialize};

use reflet_base::files::{content_hash, written_since};

/// Sidecar of the converter's output.
#[derive(Deserialize)]
pub(super) struct Sidecar {
    #[serde(default)]
    pub(super) files: Vec<PathBuf>,
    /// Missing files that were searched; the conversion is outdated once they exist.
    #[serde(default)]
    pub(super) absent: Vec<PathBuf>,
    #[serde(default)]
    pub(super) warnings: Vec<SidecarWarning>,
}

/// A conversion loss.
#[derive(Deserialize, Serialize)]
pub(super) struct SidecarWarning {
    pub(super) name: String,
    pub(super) prim: String,
    pub(super) message: String,
}

/// A cached conversion, valid while converter, inputs and output are unchanged.
#[derive(Deserialize, Serialize)]
pub(super) struct Record {
    /// The converter's version.
    pub(super) converter: String,
    /// Length and hash of the converted file.
    pub(super) glb: (u64, String),
    /// Hashes of the files that the conversion read or searched.
    pub(super) inputs: Inputs,
    /// Files that the conversion read.
    pub(super) files: Vec<PathBuf>,
    pub(super) warnings: Vec<SidecarWarning>,
}

impl Record {
    /// Reads a record; `None` if it is invalid.
    pub(super) fn read(path: &Path) -> Option<Self> {
        serde_json::from_slice(&fs::read(path).ok()?).ok()
    }

    /// Whether the record is still valid.
    pub(super) fn holds(&self, glb: &Path, converter: &str) -> bool {
        self.converter == converter
            && fs::metadata(glb).is_ok_and(|file| file.len() == self.glb.0)
            && self.inputs == Inputs::hash(self.inputs.paths())
            && output(glb).as_ref() == Some(&self.glb)
    }
}

/// Length and hash of a converted file; `None` where it cannot be read.
pub(super) fn output(glb: &Path) -> Option<(u64, String)> {
    Some((fs::metadata(glb).ok()?.len(), hash_of(glb)?))
}

/// Files that a conversion read or searched, each with its content hash, or none if missing.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub(super) struct Inputs(BTreeMap<PathBuf, Option<String>>);

impl Inputs {
    /// Hashes the current content of these files.
    pub(super) fn hash<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        let hashed = paths.into_iter().map(|path| (path.clone(), hash_of(path)));
        Self(hashed.collect())
    }

    /// Paths of the files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.0.keys()
    }

    /// Whether none of these files changed in a conversion that began at `since`; `before` has the hashes of some
    /// of them from before. The read files are only known afterwards, so the others are checked by modification
    /// time.
    pub(super) fn are_steady(&self, before: &Self, since: SystemTime) -> bool {
        self.0.iter().all(|(path, hash)| match before.0.get(path) {
            Some(earlier) => earlier == hash,
            None => !written_since(path, since),
        })
    }
}

fn hash_of(path: &Path) -> Option<String> {
    content_hash(path).ok().map(|hash| super::hex(&hash))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn inputs_are_steady_by_content_or_by_time() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let (file, none) = (folder.join("a.usda"), folder.join("b.usda"));
        fs::write(&file, "one").expect("written");
        let paths = [file.clone(), none.clone()];
        let before = Inputs::hash(&paths);
        let now = SystemTime::now();
        let later = now + Duration::from_secs(60);
        let earlier = now - Duration::from_secs(60);
        let unknown = Inputs::default();
        let same = Inputs::hash(&paths);
        assert!(same.are_steady(&before, earlier), "its content is known");
        assert!(same.are_steady(&unknown, later), "it was there long before");
        assert!(!same.are_steady(&unknown, earlier), "it may be new");
        fs::write(&none, "two").expect("written");
        let came = Inputs::hash(&paths);
        assert!(!came.are_steady(&before, later), "a file came");
        fs::write(&file, "two").expect("written");
        assert!(
            !Inputs::hash(&paths).are_steady(&came, later),
            "one changed"
        );
    }
}
