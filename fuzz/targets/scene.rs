//! Reads any text as a scene without files beside it, and poses its first frame.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use reflet_scene::stages::{Animator, Scene};
use reflet_world::load::{LoadOptions, load};

fuzz_target!(|text: &str| {
    let file = Path::new("/nonexistent/scene.toml");
    let Ok((scene, _)) = Scene::from_text(text, file, &[]) else {
        return;
    };
    let first = scene.first_frame();
    let state = Animator::new(&scene).pose(first);
    let (Ok(state), Ok(mut world)) = (state, load(&scene, &LoadOptions::default())) else {
        return;
    };
    let _ = world.apply(&state);
});
