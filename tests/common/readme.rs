//! Example files of the README, section by section.

use std::{fs, path::Path};

/// Blocks of code of the README that belong to one scene.
pub struct Story {
    scene: String,
    motion: String,
    /// Scene that is a variation of the first one, `my.toml`.
    pub shot: String,
    /// Scene in which a rigged lamp, `lamp.toml`, is placed.
    pub rig: String,
    /// Line of the scene that refers to the script.
    pub script_line: String,
    /// File name of the script.
    pub script_name: String,
    /// Text of the script.
    pub script: String,
}

impl Story {
    /// Reads the blocks from the README beside the manifest.
    pub fn read() -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
        let readme = fs::read_to_string(path).expect("README.md");
        let blocks = |fence: &str| -> Vec<String> {
            let after = readme.split(fence).skip(1);
            let block = |text: &str| text.split_once("```").expect("its end").0.to_owned();
            after.map(block).collect()
        };
        let mut toml = blocks("```toml\n").into_iter();
        let mut next = || toml.next().expect("a block");
        let (scene, motion, script_line) = (next(), next(), next());
        let script_name = script_line.split('"').nth(1).expect("a name").to_owned();
        let shot = toml.find(|block| block.contains("base = \"my.toml\""));
        let rig = toml.find(|block| block.contains("scene = \"lamp.toml\""));
        let script = blocks("```rust\n").swap_remove(0);
        Self {
            scene,
            motion,
            shot: shot.expect("a scene with a base"),
            rig: rig.expect("a scene with a rig"),
            script_line,
            script_name,
            script,
        }
    }

    /// Scene texts of the steps: the scene alone, in motion, and with its script.
    pub fn scenes(&self) -> [String; 3] {
        let moving = format!("{}\n{}", self.scene, self.motion);
        let scripted = format!("{}{moving}", self.script_line);
        [self.scene.clone(), moving, scripted]
    }
}
