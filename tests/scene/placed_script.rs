//! Scripts of placed scenes.

use reflet::scene::{
    desc::{LightKind, ParamValue},
    motion::FrameState,
};

use crate::kit::*;

const CAR: &str = include_str!("placed_script/car.toml");

const DRIVE: &str = include_str!("placed_script/drive.rhai");

const SHOT: &str = include_str!("placed_script/shot.toml");

const PAIR: &str = include_str!("placed_script/pair.toml");

fn folder(shot: &str, drive: &str) -> Folder {
    let files = [
        ("shot/scene.toml", shot),
        (
            "shot/own.rhai",
            "fn frame(ctx) { ctx.place(\"left.body\", [0, 0, 100]); }",
        ),
        ("library/cars/car.toml", CAR),
        ("library/cars/pair.toml", PAIR),
        ("library/cars/drive.rhai", drive),
        (
            "library/cars/parts/road.rhai",
            "fn at(speed, t) { speed * t }",
        ),
    ];
    Folder::with(&files)
}

fn pose(scene: &Scene, frame: u32) -> FrameState {
    Animator::new(scene).pose(frame).expect("valid")
}

#[track_caller]
fn place(scene: &Scene, state: &FrameState, name: &str) -> Vec3 {
    let mut names = scene.node_names();
    let index = names.position(|known| known == Some(name));
    let index = index.unwrap_or_else(|| panic!("no {name}"));
    state.instances[index].translation.into()
}

#[track_caller]
fn assert_places(shot: &str, frame: u32, name: &str, expected: Vec3) {
    let scene = folder(shot, DRIVE).expect();
    assert_eq!(place(&scene, &pose(&scene, frame), name), expected);
}

#[test]
fn each_placed_scene_is_moved_by_its_own_script() {
    let scene = folder(SHOT, DRIVE).expect();
    assert!(!scene.is_still());
    let state = pose(&scene, 4);
    for (car, x) in [("left", -5.0), ("right", 5.0)] {
        let at = |name: &str| place(&scene, &state, &format!("{car}.{name}"));
        assert_eq!(at("body"), Vec3::new(x, 0.0, 2.0));
        assert_eq!(at("bolt1"), Vec3::new(x + 1.0, 0.0, 2.0), "by setup");
    }
    assert!(
        scene
            .models
            .iter()
            .all(|m| m.name.ends_with(".body") || m.name.ends_with(".bolt"))
    );
    let bolts = scene
        .instances
        .iter()
        .filter(|i| i.model.value.ends_with(".bolt"));
    assert_eq!(bolts.count(), 4, "none beside those of setup");
    let lights: Vec<_> = scene.lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(lights.len(), 4, "{lights:?}");
    let beam = scene.lights.iter().position(|l| l.name == "left.beam");
    let LightKind::Point { position, .. } = state.lights[beam.expect("it comes along")].kind else {
        panic!("it is a point");
    };
    // The script sees world positions, and the light is a child of its car.
    assert_eq!(position, Vec3::new(-10.0, 0.0, 0.0));
    let files = scene.text_files();
    for name in ["drive.rhai", "road.rhai", "car.toml"] {
        assert!(
            files.iter().any(|file| file.ends_with(name)),
            "{name} in {files:?}"
        );
    }
    let log: Vec<_> = scene.scripts().flat_map(|s| &s.setup_log).collect();
    assert_eq!(log.len(), 1, "once a file: {log:?}");
    assert!(log[0].ends_with("7 frames"), "{log:?}");
}

#[test]
fn the_scene_of_the_placed_ones_has_the_last_word() {
    let shot = format!("script = \"own.rhai\"\n{SHOT}");
    assert_places(&shot, 4, "left.body", Vec3::new(-5.0, 0.0, 100.0));
    assert_places(&shot, 4, "right.body", Vec3::new(5.0, 0.0, 2.0));
}

#[test]
fn scripts_of_inner_scenes_have_the_names_of_their_own_scene() {
    let shot = SHOT.replacen("car.toml", "pair.toml", 1);
    assert_places(&shot, 2, "left.inner.body", Vec3::new(-5.0, 1.0, 1.0));
    assert_places(&shot, 2, "right.body", Vec3::new(5.0, 0.0, 1.0));
}

#[test]
fn each_placed_scene_has_its_own_params() {
    let shot = SHOT.replacen(
        "\"cars/car.toml\" }",
        "\"cars/car.toml\", params = { bolts = 3, speed = 2 } }",
        1,
    );
    let scene = folder(&shot, DRIVE).expect();
    let state = pose(&scene, 4);
    assert_eq!(place(&scene, &state, "left.body").z, 8.0);
    assert_eq!(place(&scene, &state, "right.body").z, 2.0);
    let named = |start: &str| {
        let names = scene.node_names().flatten();
        names.filter(|name| name.starts_with(start)).count()
    };
    assert_eq!([named("left.bolt"), named("right.bolt")], [3, 2]);
    assert_eq!(scene.scripts().count(), 1, "one file");
    let given = scene.placed_params.iter();
    let given = given.map(|(group, all)| (group.as_str(), all.iter().map(|p| &p.value)));
    let given: Vec<_> = given
        .map(|(group, all)| (group, all.collect::<Vec<_>>()))
        .collect();
    let (three, two) = (ParamValue::Integer(3), ParamValue::Integer(2));
    assert_eq!(given.len(), 2);
    assert!(
        given[0].0 == "left" && given[0].1.contains(&&three),
        "{given:?}"
    );
    assert!(
        given[1].0 == "right" && given[1].1.contains(&&two),
        "{given:?}"
    );
    let set = "instance.left.model.params.speed=3";
    let scene = or_panic!(folder(&shot, DRIVE).read(&[], &[set]));
    assert_eq!(place(&scene, &pose(&scene, 4), "left.body").z, 12.0);
}

#[test]
fn what_is_wrong_in_a_placed_scene_is_named_as_it_is_written_there_once() {
    for (from, to, place) in [
        ("model: \"bolt\"", "model: \"bold\"", "drive.rhai:"),
        ("parent: \"body\"", "parent: \"bod\"", "drive.rhai:"),
    ] {
        let drive = DRIVE.replacen(from, to, 1);
        let errors = (folder(SHOT, &drive).read(&[], &[])).expect_err("no such name");
        let wrong = to.split('"').nth(1).expect("in quotes");
        for says in [
            format!("named \"{wrong}\""),
            "did you mean \"bo".to_owned(),
            "in \"left\", which is placed here".to_owned(),
            place.to_owned(),
        ] {
            assert!(errors.contains(&says), "no {says:?} in\n{errors}");
        }
        assert!(
            !errors.contains("left.") && !errors.contains("right"),
            "{errors}"
        );
    }
    let shot = format!("{SHOT}parent = \"left.bod\"\n");
    let errors = folder(&shot, DRIVE).read(&[], &[]);
    let errors = errors.expect_err("no such name");
    assert!(
        errors.contains("named \"left.bod\""),
        "the scene's own: {errors}"
    );
}

#[test]
fn params_that_a_placed_scene_does_not_have_are_refused() {
    for (params, says) in [
        (
            "params = { sped = 2 }",
            "no parameter is named \"sped\"\n --> shot/scene.toml:6:47",
        ),
        (
            "params = { bolts = 2.5 }",
            "`bolts` is a whole number, not 2.5",
        ),
        ("params = 3", "`params` must be a table"),
        ("parms = { speed = 2 }", "did you mean `params`?"),
    ] {
        let with = format!("\"cars/car.toml\", {params} }}");
        let shot = SHOT.replacen("\"cars/car.toml\" }", &with, 1);
        folder(&shot, DRIVE).assert_says(&[], &[says]);
    }
}

#[test]
fn mistakes_of_placed_scripts_are_named() {
    let frame = folder(
        SHOT,
        &DRIVE.replace("ctx.place(\"body\"", "ctx.place(\"boddy\""),
    );
    frame.assert_frame("no instance is named \"boddy\" (in frame 0); Some(\"did you mean");
    let errors = frame.expect().pose(0).expect_err("it is wrong");
    let (at, note) = errors[0].related.as_ref().expect("the place of the scene");
    assert_eq!(&SHOT[at.range.clone()], "\"left\"");
    assert_eq!(note, "in \"left\", which is placed here");
    for (from, to, says) in [
        (
            "script = \"drive.rhai\"",
            "script = \"dive.rhai\"",
            "does not exist",
        ),
        (
            "script = \"drive.rhai\"",
            "script = 3",
            "`script` must be text in quotes",
        ),
    ] {
        let folder = folder(SHOT, DRIVE);
        let car = CAR.replacen(from, to, 1);
        std::fs::write(folder.path("library/cars/car.toml"), car).expect("writable");
        folder.assert_says(&[], &[says, "car.toml:2"]);
    }
    let wrong = DRIVE.replace("model: \"bolt\"", "model: \"bold\"");
    folder(SHOT, &wrong).assert_says(&[], &["\"bold\"", "drive.rhai:5"]);
}

/// A mistake in a scene that is placed several times is one mistake.
#[test]
fn a_mistake_of_a_placed_scene_is_told_once() {
    let bulb = "version = 1\n[material.glow]\nroughnes = 0.5\n";
    let placed = |name: &str| {
        format!("[[instance]]\nname = \"{name}\"\nmodel = {{ scene = \"bulb.toml\" }}\n")
    };
    let scene = ["version = 1\n".to_owned(), placed("left"), placed("right")].concat();
    let files = [
        ("shot/scene.toml", scene.as_str()),
        ("shot/bulb.toml", bulb),
    ];
    let errors = Folder::with(&files).read(&[], &[]).expect_err("a mistake");
    assert_eq!(
        errors.matches("roughnes` is not a key").count(),
        1,
        "{errors}"
    );
}
