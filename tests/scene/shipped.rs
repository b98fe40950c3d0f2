//! Every scene that ships, and the one in the README, reads and loads.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::common::shared_folder;
use reflet::{
    scene::{diagnostic::Diagnostic, motion::Motion, parse},
    world::load::{self, LoadOptions},
};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scenes_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("scenes");
    let mut found = Vec::new();
    for path in entries.map(|entry| entry.expect("entry").path()) {
        if path.is_dir() {
            found.extend(scenes_below(&path));
        } else if path.extension().is_some_and(|e| e == "toml") {
            found.push(path);
        }
    }
    found
}

fn said(messages: &[Diagnostic]) -> String {
    messages.iter().map(ToString::to_string).collect()
}

#[test]
fn every_shipped_scene_loads() {
    let assets = shared_folder("REFLET_ASSETS", "assets");
    let options = LoadOptions {
        assets: assets.clone().into_iter().collect(),
        ..LoadOptions::default()
    };
    let scenes = scenes_below(&root().join("scenes"));
    assert!(scenes.len() >= 4, "{scenes:?}");
    for path in scenes {
        let name = path.display();
        let (desc, warnings) =
            parse::load(&path, &[]).unwrap_or_else(|e| panic!("{name}\n{}", said(&e)));
        assert!(warnings.is_empty(), "{name}\n{}", said(&warnings));
        match load::load(&desc, &options) {
            Ok(world) => assert!(!world.instances.is_empty(), "{name} shows nothing"),
            Err(errors)
                if assets.is_none() && errors.iter().all(|e| e.name == "file-not-found") =>
            {
                eprintln!("SKIPPED: {name} needs assets");
            }
            Err(errors) => panic!("{name}\n{}", said(&errors)),
        }
    }
}

#[test]
fn the_scene_in_the_readme_loads() {
    let readme = fs::read_to_string(root().join("README.md")).expect("README.md");
    let (_, after) = readme.split_once("```toml\n").expect("a scene");
    let (text, _) = after.split_once("```").expect("its end");
    let (desc, warnings) =
        parse::parse(text, Path::new("README.md"), &[]).unwrap_or_else(|e| panic!("{}", said(&e)));
    assert!(warnings.is_empty(), "{}", said(&warnings));
    let world = load::load(&desc, &LoadOptions::default());
    assert!(world.is_ok());
}

#[test]
fn the_script_in_the_readme_poses_its_scene() {
    let readme = fs::read_to_string(root().join("README.md")).expect("README.md");
    let block = |fence: &str| {
        let (_, after) = readme.split_once(fence).expect("a block");
        after.split_once("```").expect("its end").0
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readme");
    fs::create_dir_all(&folder).expect("temporary folder");
    fs::write(folder.join("hop.rhai"), block("```rust\n")).expect("written");
    let scene = block("```toml\n");
    let text = format!("script = \"hop.rhai\"\n{scene}\n[timeline]\nend = 47\n");
    let (desc, warnings) = parse::parse(&text, &folder.join("scene.toml"), &[])
        .unwrap_or_else(|e| panic!("{}", said(&e)));
    assert!(warnings.is_empty(), "{}", said(&warnings));
    let motion = Motion::new(&desc);
    let [first, later] = [0, 7].map(|frame| {
        motion
            .pose(frame)
            .unwrap_or_else(|e| panic!("{}", said(&e)))
    });
    assert_eq!(first.instances.len(), 4);
    assert_ne!(first.instances[3], later.instances[3]);
    assert_ne!(first.materials, later.materials);
}
