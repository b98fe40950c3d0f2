//! Parents of instances, lights and cameras, at rest, moved by tracks and by scripts; and invalid ones.

use reflet::{
    scene::{desc::LightKind, motion::FrameState},
    world::{World, load},
};

use crate::kit::*;

const RIG: &str = include_str!("hierarchy/rig.toml");

fn read(text: &str) -> Scene {
    let (scene, warnings) = Scene::from_text(text, Path::new("scene.toml"), &[]).expect("valid");
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

fn pose(scene: &Scene, frame: u32) -> FrameState {
    Animator::new(scene).pose(frame).expect("valid")
}

fn loaded(scene: &Scene) -> World {
    load::load(scene, &load::LoadOptions::default()).expect("valid")
}

#[track_caller]
fn assert_at(found: impl Into<Vec3>, want: [f32; 3]) {
    let found = found.into();
    assert!(found.distance(Vec3::from(want)) < 1e-5, "{found} {want:?}");
}

#[track_caller]
fn assert_rig(world: &World) {
    let at = |i: usize| world.instances[i].world_from_object.translation;
    // +X of the base points along -Z.
    assert_at(at(0), [10.0, 1.0, -1.0]);
    assert_at(at(1), [10.0, 1.0, 0.0]);
    assert_at(at(2), [10.0, 1.0, -3.0]);
    assert_at(at(3), [0.0, 0.0, 9.0]);
    let camera = &world.cameras[0].value;
    assert_at(camera.eye, [12.0, 1.0, 0.0]);
    assert_at(camera.target, [10.0, 1.0, 0.0]);
    let LightKind::Spot {
        position,
        direction,
        target,
        ..
    } = world.lights[0].desc.kind
    else {
        panic!("it is a spot");
    };
    assert_at(position, [10.0, 1.0, -2.0]);
    assert_at(direction, [0.0, -1.0, 0.0]);
    assert_at(target.expect("it has one"), [10.0, 0.0, -2.0]);
}

#[test]
fn parents_place_what_hangs_on_them() {
    let scene = read(RIG);
    let world = loaded(&scene);
    assert_rig(&world);
    assert!(world.instances.iter().all(|i| !i.dynamic));
}

#[test]
fn tracks_of_parents_move_what_hangs_on_them() {
    let text = format!("{RIG}[motion.group.base]\ntranslation = {{ rate = [0, 0, 2] }}\n");
    let scene = read(&text);
    let mut world = loaded(&scene);
    let moves: Vec<_> = world.instances.iter().map(|i| i.dynamic).collect();
    assert_eq!(moves, [true, true, true, false]);
    world.apply(&pose(&scene, 0)).expect("it can be posed");
    assert_rig(&world);
    world.apply(&pose(&scene, 3)).expect("it can be posed");
    let at = |i: usize| world.instances[i].world_from_object.translation;
    assert_at(at(0), [10.0, 1.0, 2.0]);
    assert_at(at(2), [10.0, 1.0, 0.0]);
    assert_at(world.cameras[0].value.eye, [12.0, 1.0, 3.0]);
    let lamp = &world.lights[0].desc.kind;
    assert_at(lamp.position().expect("it has one"), [10.0, 1.0, 1.0]);
}

#[test]
fn what_hangs_on_something_hidden_is_hidden() {
    let keys = "{ keys = [{ at_s = 1, value = false }, { at_s = 3, value = true }], loop_s = 4 }";
    let text = format!("{RIG}[motion.group.base]\nshown = {keys}\n");
    let scene = read(&text);
    let mut world = loaded(&scene);
    let mut shown = |frame: u32| {
        let state = pose(&scene, frame);
        world.apply(&state).expect("it can be posed");
        let hidden = world.instances.iter().map(|i| !i.is_hidden());
        let lit = world.lights[0].desc.color != Vec3::ZERO;
        (hidden.collect::<Vec<_>>(), lit)
    };
    // Half a second per frame; the loop begins with the first key.
    let (there, gone) = (
        (vec![true; 4], true),
        (vec![false, false, false, true], false),
    );
    for (frame, want) in [
        (0, &there),
        (2, &gone),
        (5, &gone),
        (6, &there),
        (9, &there),
        (10, &gone),
    ] {
        assert_eq!(shown(frame), *want, "frame {frame}");
    }
}

#[test]
fn what_hangs_on_a_thing_follows_another_in_the_world() {
    let track = "[motion.camera.main]\ntarget = { follow = { instance = \"still\" } }\n";
    let scene = read(&format!("{RIG}{track}"));
    let camera = &pose(&scene, 0).cameras[0];
    let view = (camera.target - camera.eye).normalize();
    let want = (Vec3::new(0.0, 0.0, 9.0) - camera.eye).normalize();
    assert_at(view, want.to_array());
    let track = "[motion.camera.main]\ntarget = { follow = { instance = \"base\" } }\n";
    let camera = &pose(&read(&format!("{RIG}{track}")), 0).cameras[0];
    assert_at(camera.target, [10.0, 0.0, 0.0]);
}

#[test]
fn scripts_move_groups_and_see_the_world() {
    let folder = Folder::with(&[
        ("shot/scene.toml", &format!("script = \"move.rhai\"\n{RIG}")),
        (
            "shot/move.rhai",
            include_str!("hierarchy/scripts_move_groups_and_see_the_world.rhai"),
        ),
    ]);
    folder.assert_frame("\"base\" stands still (in frame 0); Some(\"write `dynamic = true`");
    let path = folder.path("shot/scene.toml");
    let text = fs::read_to_string(&path).expect("it is there");
    let text = text.replace("[group.base]", "[group.base]\ndynamic = true");
    fs::write(&path, text).expect("it can be written");
    let scene = folder.expect();
    let state = pose(&scene, 4);
    assert_at(state.instances[0].translation, [10.0, 3.0, -2.0]);
    assert_says(&state.log[0], &["vec3(10, 3, -1.99"]);
}

#[test]
fn wrong_parents_are_named() {
    for (change, says) in cases(include_str!("hierarchy/wrong_parents_are_named.txt")) {
        let (from, to) = change.split_once("\n->\n").expect("a change");
        let text = RIG.replacen(from, to, 1);
        assert_ne!(text, RIG, "{from}");
        let read = Scene::from_text(&text, Path::new("scene.toml"), &[]);
        let errors = read.expect_err("it is wrong");
        let all: String = errors
            .iter()
            .map(|e| format!("{e}\n{:?}\n", e.help))
            .collect();
        let plain = all.replace("\\\"", "\"");
        assert!(plain.contains(says), "no {says:?} in {plain}");
        assert_eq!(errors.len(), 1, "{plain}");
    }
}

#[test]
fn a_parent_that_a_layer_removes_is_named() {
    let folder = Folder::with(&[
        (
            "shot/scene.toml",
            "version = 1\nbase = \"rig.toml\"\nremove = [\"group.base\"]\n",
        ),
        ("shot/rig.toml", RIG),
    ]);
    folder.assert_says(
        &[],
        &[
            "no instance or group is named \"base\"",
            "rig.toml:24:10",
            "a layer removes it here",
            "scene.toml:3:11",
        ],
    );
}

#[test]
fn deep_chains_are_placed() {
    let mut text = "version = 1\n[camera.main]\n[group.n0]\n".to_owned();
    for i in 1..10_000 {
        let group = format!(
            "[group.n{i}]\nparent = \"n{}\"\ntranslation = [1, 0, 0]\n",
            i - 1
        );
        text.push_str(&group);
    }
    text += "[model.ball]\nshape = { kind = \"sphere\" }\n";
    text += "[[instance]]\nmodel = \"ball\"\nparent = \"n9999\"\n";
    let world = loaded(&read(&text));
    assert_at(
        world.instances[0].world_from_object.translation,
        [9999.0, 0.0, 0.0],
    );
}

#[test]
fn points_of_a_table_place_copies() {
    let text = RIG.replace(
        "repeat = { count = [2, 1, 1], step = [3, 0, 0] }",
        "instances_from = \"points.csv\"\nscale = 2",
    );
    let folder = Folder::with(&[
        ("shot/scene.toml", text.as_str()),
        ("shot/points.csv", "x,y,z,scale\n0,0,0,1\n3,0,0,0.5\n"),
    ]);
    let read = |folder: &Folder| load::load(&folder.expect(), &load::LoadOptions::default());
    let world = read(&folder).expect("valid");
    let [a, b] = [1, 2].map(|i| &world.instances[i]);
    assert_eq!([a.name.as_str(), b.name.as_str()], ["row[0]", "row[1]"]);
    assert_at(a.world_from_object.translation, [10.0, 1.0, 0.0]);
    assert_at(b.world_from_object.translation, [10.0, 1.0, -3.0]);
    let grown = b.world_from_object.transform_vector3(Vec3::Y).length();
    assert!((grown - 1.0).abs() < 1e-5, "{grown}");
    assert!(world.files.iter().any(|f| f.ends_with("points.csv")));

    let moving = format!("{text}[motion.group.base]\ntranslation = {{ rate = [0, 0, 2] }}\n");
    let path = folder.path("shot/scene.toml");
    fs::write(&path, moving).expect("it can be written");
    let scene = folder.expect();
    let mut world = read(&folder).expect("valid");
    world.apply(&pose(&scene, 3)).expect("it can be posed");
    assert_at(
        world.instances[2].world_from_object.translation,
        [10.0, 1.0, 0.0],
    );

    fs::write(folder.path("shot/points.csv"), "x,y,z\n1,2\n").expect("it can be written");
    let errors = read(&folder).expect_err("it is wrong");
    let text = errors[0].to_string();
    assert!(text.contains("points.csv:2:4"), "{text}");
    assert_says(&text, &["named here", "scene.toml:18:18"]);
    fs::remove_file(folder.path("shot/points.csv")).expect("it can be removed");
    let errors = read(&folder).expect_err("it is wrong");
    assert_eq!(errors[0].name, "file-not-found");
}
