//! Text files of a scene besides its own: scripts and included scene text.

use std::{path::PathBuf, sync::Arc};

use super::SceneDesc;
use crate::diagnostic::Source;

impl SceneDesc {
    /// Paths of the scripts, their imports and the included scene text, with symbolic links resolved.
    pub fn text_files(&self) -> Vec<PathBuf> {
        let of_script = self.scripts().flat_map(|s| &s.files).cloned();
        let included = self.includes.iter().map(|file| file.path.clone());
        of_script.chain(included).collect()
    }
}

/// A file of scene text that another file includes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Include {
    /// Name of the file relative to the scene's folder, as `include` writes it.
    pub name: String,
    /// Path of the file, with symbolic links resolved.
    pub path: PathBuf,
    /// Text of the file, with its syntax tree.
    pub source: Arc<Source>,
}
