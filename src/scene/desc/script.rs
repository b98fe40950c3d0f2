//! Metadata of a scene's script: its files, functions and log; the program itself is not here.

use std::path::PathBuf;

use super::SceneDesc;

impl SceneDesc {
    /// Scripts of the scene itself and of placed scenes.
    pub fn scripts(&self) -> impl Iterator<Item = &ScriptDesc> {
        self.script.iter().chain(&self.placed_scripts)
    }

    /// Whether any script has `fn frame(ctx)`, which poses frames.
    pub fn has_frame_script(&self) -> bool {
        self.scripts().any(|script| script.has_frame)
    }
}

/// `script = "….rhai"`, after its `setup` was run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ScriptDesc {
    /// Name of the file in messages: the scene's folder and the name in the scene.
    pub name: String,
    /// Whether the script has `fn frame(ctx)`, so that frames may differ.
    pub has_frame: bool,
    /// Name and text of the script and of each file that it imports, the script first.
    pub texts: Vec<(String, String)>,
    /// Paths of these files, with symbolic links resolved, for fingerprints and watching.
    pub files: Vec<PathBuf>,
    /// Lines that `setup` printed.
    pub setup_log: Vec<String>,
}
