//! Loads any bytes as a glTF file that a scene places and plays, and poses a frame of it.
#![no_main]

use std::{fs, path::PathBuf, sync::LazyLock};

use libfuzzer_sys::fuzz_target;
use reflet::{
    scene::stages::{Animator, Scene},
    world::load::{LoadOptions, load},
};

const SCENE: &str = r#"
version = 1
[timeline]
end = 24
[model.m]
file = "m.glb"
animation = "*"
"#;

/// Lives as long as the process.
static FOLDER: LazyLock<PathBuf> =
    LazyLock::new(|| tempfile::tempdir().expect("a temporary folder").keep());
static READ: LazyLock<Scene> = LazyLock::new(|| {
    let read = Scene::from_text(SCENE, &FOLDER.join("scene.toml"), &[]);
    read.expect("the scene is right").0
});

fuzz_target!(|bytes: &[u8]| {
    fs::write(FOLDER.join("m.glb"), bytes).expect("it can be written");
    // Half a GiB is left for what is copied.
    let options = LoadOptions {
        memory_bytes: Some(1 << 30),
        ..LoadOptions::default()
    };
    let Ok(mut world) = load(&READ, &options) else {
        return;
    };
    let state = Animator::new(&READ).pose(12).expect("nothing but the file moves");
    // What is not finite is refused.
    let _ = world.apply(&state);
});
