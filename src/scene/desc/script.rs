//! A scene's script as data: what it is made of, not the program.

use std::path::PathBuf;

use super::SceneDesc;

impl SceneDesc {
    /// The scene's own script, and those of placed scenes.
    pub fn scripts(&self) -> impl Iterator<Item = &ScriptDesc> {
        self.script.iter().chain(&self.placed_scripts)
    }

    /// Whether a script poses frames.
    pub fn has_frame_script(&self) -> bool {
        self.scripts().any(|script| script.has_frame)
    }
}

/// `script = "….rhai"` after its `setup` was run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ScriptDesc {
    /// What messages call its file: the scene's folder and the name in the scene.
    pub name: String,
    /// Whether it has `fn frame(ctx)`, so that frames may differ.
    pub has_frame: bool,
    /// Name and text of every file that it consists of, itself first.
    pub texts: Vec<(String, String)>,
    /// Those files without links, for fingerprints and watching.
    pub files: Vec<PathBuf>,
    /// What `setup` printed, by line.
    pub setup_log: Vec<String>,
}
