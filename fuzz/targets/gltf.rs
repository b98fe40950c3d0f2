//! Loads any bytes as a glTF file that a scene places and animates, and poses one frame of it.
#![no_main]

use std::{fs, path::PathBuf, sync::LazyLock};

use libfuzzer_sys::fuzz_target;
use reflet_scene::stages::{Animator, Scene};
use reflet_world::load::{LoadOptions, load};

const SCENE: &str = r#"
version = 1
[timeline]
end = 24
[model.m]
file = "m.glb"
animation = "*"
"#;

/// Temporary folder that lives as long as the process.
static FOLDER: LazyLock<PathBuf> =
    LazyLock::new(|| tempfile::tempdir().expect("a temporary folder").keep());
static READ: LazyLock<Scene> = LazyLock::new(|| {
    let read = Scene::from_text(SCENE, &FOLDER.join("scene.toml"), &[]);
    read.expect("the scene is right").0
});

fuzz_target!(|bytes: &[u8]| {
    fs::write(FOLDER.join("m.glb"), bytes).expect("it can be written");
    // The loader gets 1 GiB of the fuzzer's 1.5 GB limit; the rest is for copies.
    let options = LoadOptions {
        memory_bytes: Some(1 << 30),
        // Files of odd length are read with what is forgiven.
        lenient: bytes.len() % 2 == 1,
        strict: bytes.len() % 4 == 0,
        ..LoadOptions::default()
    };
    let Ok(mut world) = load(&READ, &options) else {
        return;
    };
    let state = Animator::new(&READ).pose(12).expect("nothing but the file moves");
    // Poses with values that are not finite are refused with an error.
    let _ = world.apply(&state);
});
