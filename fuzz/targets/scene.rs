//! Reads any text as a scene, and poses its first frame. Lines `#file` part it: after each comes a file, `0.toml`,
//! `1.toml`…, that the scene may place, include or extend.
#![no_main]

use std::{fs, path::PathBuf, sync::LazyLock};

use libfuzzer_sys::fuzz_target;
use reflet_scene::stages::{Animator, Scene};
use reflet_world::load::{LoadOptions, load};

/// Temporary folder that lives as long as the process.
static FOLDER: LazyLock<PathBuf> =
    LazyLock::new(|| tempfile::tempdir().expect("a temporary folder").keep());

fuzz_target!(|text: &str| {
    let mut parts = text.split("\n#file\n");
    let text = parts.next().unwrap_or_default();
    let mut files = Vec::new();
    for (number, part) in parts.take(4).enumerate() {
        let file = FOLDER.join(format!("{number}.toml"));
        fs::write(&file, part).expect("it can be written");
        files.push(file);
    }
    let read = Scene::from_text(text, &FOLDER.join("scene.toml"), &[]);
    for file in files {
        fs::remove_file(file).expect("it can be removed");
    }
    let Ok((scene, _)) = read else {
        return;
    };
    let first = scene.first_frame();
    let state = Animator::new(&scene).pose(first);
    let (Ok(state), Ok(mut world)) = (state, load(&scene, &LoadOptions::default())) else {
        return;
    };
    let _ = world.apply(&state);
});
