//! A small animated glTF file: a polished floor, and an arm with a red, glowing hand.

use std::{fs, path::Path};

/// Writes `arm.gltf` and its buffer. Node `hand` is a child of `arm`; `swing` rotates the arm about Y by a
/// quarter turn in 1 s, `lift` raises it by 1 m and scales the hand to 0 in 2 s. The floor's top
/// is at y = 0, the hand's center at (1, 0.5, 0).
pub fn write_arm(folder: &Path) {
    fs::write(folder.join("arm.bin"), include_bytes!("animated/arm.bin")).expect("written");
    fs::write(folder.join("arm.gltf"), include_str!("animated/arm.gltf")).expect("written");
}
