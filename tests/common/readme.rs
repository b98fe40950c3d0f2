//! Example files of the README and of the guide that goes on from it.

use std::{fs, path::Path};

/// The README's scene and the code blocks of the guide that change it.
pub struct Story {
    scene: String,
    motion: String,
    /// Scene in which a rigged lamp, `lamp.toml`, is placed.
    pub rig: String,
    /// Lines of the scene that name the script and give its parameters.
    pub script_lines: String,
    /// File name of the script.
    pub script_name: String,
    /// Text of the script.
    pub script: String,
}

impl Story {
    /// Reads the blocks from the README and the guide.
    pub fn read() -> Self {
        let [readme, guide] = ["README.md", "docs/guide.md"].map(|name| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
            fs::read_to_string(path).expect(name)
        });
        let blocks = |page: &str, fence: &str| -> Vec<String> {
            let after = page.split(fence).skip(1);
            let block = |text: &str| text.split_once("```").expect("its end").0.to_owned();
            after.map(block).collect()
        };
        let guided = blocks(&guide, "```toml\n");
        let with = |part: &str| {
            let block = guided.iter().find(|block| block.contains(part));
            block.expect(part).clone()
        };
        let script_lines = with("script = \"");
        let script_name = script_lines.split('"').nth(1).expect("a name").to_owned();
        Self {
            scene: blocks(&readme, "```toml\n").swap_remove(0),
            motion: with("[motion.camera.main]"),
            rig: with("scene = \"lamp.toml\""),
            script_lines,
            script_name,
            script: blocks(&guide, "```rust\n").swap_remove(0),
        }
    }

    /// Scene texts of the steps: the scene alone, in motion, and with its script.
    pub fn scenes(&self) -> [String; 3] {
        let moving = format!("{}\n{}", self.scene, self.motion);
        let scripted = format!("{}{moving}", self.script_lines);
        [self.scene.clone(), moving, scripted]
    }
}
