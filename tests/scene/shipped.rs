//! All shipped scenes, and the README's scene, can be read and loaded.

use reflet::world::{load, load::LoadOptions};

use crate::{common::shared_folder, kit::*};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scenes_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("scenes");
    let mut found = Vec::new();
    for path in entries.map(|entry| entry.expect("entry").path()) {
        // Parts are read with the scenes that include or place them; a project is no scene.
        if path.is_dir() {
            if !path.ends_with("parts") {
                found.extend(scenes_below(&path));
            }
        } else if !path.ends_with("reflet.toml") && path.extension().is_some_and(|e| e == "toml") {
            found.push(path);
        }
    }
    found
}

fn said(messages: &[Diagnostic]) -> String {
    messages.iter().map(ToString::to_string).collect()
}

/// Whether a scene of the paper places Sponza, whose file takes most of the time; tests of glTF load it daily.
fn places_sponza(path: &Path) -> bool {
    path.parent()
        .is_some_and(|folder| folder.ends_with("paper"))
}

/// Whether `the_scenes_of_the_project_have_no_warnings` loads a scene.
fn is_linted(path: &Path) -> bool {
    ["scenes", "examples"]
        .iter()
        .any(|name| path.parent().is_some_and(|folder| folder.ends_with(name)))
}

#[test]
fn shipped_scenes_of_other_folders_load() {
    check_loads(|path| !places_sponza(path) && !is_linted(path));
    let read = Scene::from_file(&root().join("scenes/paper/sponza.toml"), &[]);
    assert!(read.is_ok_and(|(_, warnings)| warnings.is_empty()));
}

#[test]
#[ignore = "long: reads Sponza nine times"]
fn the_scenes_of_the_paper_load() {
    check_loads(places_sponza);
}

fn check_loads(wanted: impl Fn(&Path) -> bool) {
    let assets = shared_folder("REFLET_ASSETS", "assets");
    let options = LoadOptions {
        assets: assets.clone().into_iter().collect(),
        ..LoadOptions::default()
    };
    let scenes = scenes_below(&root().join("scenes"));
    assert!(scenes.len() >= 4, "{scenes:?}");
    for path in scenes.iter().filter(|path| wanted(path)) {
        let name = path.display();
        let (desc, warnings) =
            Scene::from_file(path, &[]).unwrap_or_else(|e| panic!("{name}\n{}", said(&e)));
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

/// Scene of the README with the changes of each step of the guide: scene, motion, script.
#[test]
fn each_step_of_the_readme_scene_is_valid() {
    let readme = crate::common::readme::Story::read();
    let folder = kept_folder("readme", &[]);
    fs::write(folder.join(&readme.script_name), &readme.script).expect("written");
    let read = |text: &str| {
        let (desc, warnings) = Scene::from_text(text, &folder.join("my.toml"), &[])
            .unwrap_or_else(|e| panic!("{}", said(&e)));
        assert!(warnings.is_empty(), "{}", said(&warnings));
        let mut world =
            load::load(&desc, &LoadOptions::default()).unwrap_or_else(|e| panic!("{}", said(&e)));
        let motion = Animator::new(&desc);
        [0, 7].map(|frame| {
            let state = motion.pose(frame);
            let state = state.unwrap_or_else(|e| panic!("{}", said(&e)));
            let applied = world.apply(&state);
            applied.unwrap_or_else(|e| panic!("{}", said(&e)));
            state
        })
    };
    let [scene, moving, scripted] = readme.scenes();
    let [first, later] = read(&scene);
    assert_eq!(first.instances, later.instances, "nothing moves yet");
    let [first, later] = read(&moving);
    assert_eq!(first.instances.len(), 4);
    assert_ne!(first.instances[3], later.instances[3]);
    assert_ne!(first.cameras, later.cameras);
    let [first, later] = read(&scripted);
    assert_eq!(first.instances.len(), 7);
    assert_ne!(first.instances[6], later.instances[6]);
    assert_ne!(first.materials, later.materials);
}

/// The guide's scene with a rig, beside the lamp of the show.
#[test]
fn the_rig_of_the_guide_is_valid() {
    let readme = crate::common::readme::Story::read();
    let path = root().join("scenes/show/guide.toml");
    let (desc, warnings) =
        Scene::from_text(&readme.rig, &path, &[]).unwrap_or_else(|e| panic!("{}", said(&e)));
    assert!(warnings.is_empty(), "{}", said(&warnings));
    let mut world =
        load::load(&desc, &LoadOptions::default()).unwrap_or_else(|e| panic!("{}", said(&e)));
    let eye = |world: &reflet::world::World| {
        let camera = world.cameras.iter().find(|c| c.name == "at_the_lamp");
        camera.expect("it is there").value.eye
    };
    let first = eye(&world);
    let state = Animator::new(&desc).pose(24);
    let state = state.unwrap_or_else(|e| panic!("{}", said(&e)));
    world
        .apply(&state)
        .unwrap_or_else(|e| panic!("{}", said(&e)));
    assert!(first.distance(eye(&world)) > 0.1, "it turns with the lamp");
}

#[test]
fn a_script_that_moves_a_scene_without_a_timeline_is_warned_about() {
    let readme = crate::common::readme::Story::read();
    let folder = kept_folder("readme-still", &[]);
    fs::write(folder.join(&readme.script_name), &readme.script).expect("written");
    let [scene, ..] = readme.scenes();
    let text = format!("{}{scene}", readme.script_lines);
    let (_, warnings) = Scene::from_text(&text, &folder.join("my.toml"), &[])
        .unwrap_or_else(|e| panic!("{}", said(&e)));
    let text = said(&warnings);
    for part in [
        "no-timeline",
        "my.toml:1:10",
        "the script has `fn frame(ctx)`, but there is no `[timeline]`",
    ] {
        assert!(text.contains(part), "no {part:?} in {text}");
    }
}
