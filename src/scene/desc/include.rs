//! The texts that a scene is written in besides its own file.

use std::path::PathBuf;

use super::SceneDesc;

impl SceneDesc {
    /// The scripts, what they import and included scene text, without links.
    pub fn text_files(&self) -> Vec<PathBuf> {
        let of_script = self.scripts().flat_map(|s| &s.files).cloned();
        let included = self.includes.iter().map(|file| file.path.clone());
        of_script.chain(included).collect()
    }
}

/// A file of scene text that another includes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Include {
    /// From the scene's folder, as it is named.
    pub name: String,
    /// The file, without links.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}
