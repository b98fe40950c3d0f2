//! Animations of glTF files: names, errors of invalid ones, and ignored parts.

use glam::Affine3A;
use reflet::{
    runtime::scene_text::{SceneOptions, SceneText},
    world::{gltf, load},
};

use crate::{
    animation::{assert_near, cart, cart_scene, find, playing, posed},
    kit::*,
};

#[test]
fn unknown_names_are_reported_with_their_places() {
    let (_folder, mut desc) = cart_scene(&["spinn"]);
    let errors = load_scene(&desc).expect_err("there is no such animation");
    assert_eq!(errors[0].name, "unknown-animation");
    assert!(errors[0].message.contains("no animation \"spinn\""));
    let help = errors[0].help.as_deref().unwrap_or_default();
    assert_says(help, &["\"spin\"", "drive, spin, turn"]);
    desc.models[0].value.animation = None;
    desc.instances = vec![InstanceDesc {
        animation: Some(playing(&["*", "fly"])),
        ..instance("m")
    }];
    let (name, message) = one_error(load_scene(&desc));
    assert_eq!(name, "unknown-animation", "{message}");
}

/// Missing names are generated, and names are made unique.
#[test]
fn every_animation_has_a_name_of_its_own() {
    let mut doc = cart();
    for (i, name) in [json!("go"), json!("go"), Value::Null]
        .into_iter()
        .enumerate()
    {
        doc.json["animations"][i]["name"] = name;
    }
    let world = doc.world();
    let names: Vec<_> = world.animations.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["go", "go#2", "animation 2"]);
}

/// Asserts that the first animation of a cart cannot be played for a reason, and that the others can.
#[track_caller]
fn assert_broken(doc: &Doc, says: &str) {
    let (_folder, mut desc) = doc.scene();
    let world = load_scene(&desc).unwrap_or_else(|e| panic!("{says}: {e:?}"));
    assert_eq!(warnings(&world), ["animation-broken"], "{says}");
    assert!(world.warnings[0].file.is_some(), "{says}");
    assert_eq!(world.animations[0].channels, 0, "{says}");
    desc.models[0].value.animation = Some(playing(&["spin"]));
    assert_near(
        find(&posed(&desc, 12), "m/cart/wheel").0,
        Affine3A::from_translation(Vec3::Y)
            * Affine3A::from_rotation_z(std::f32::consts::FRAC_PI_4),
    );
    desc.models[0].value.animation = Some(playing(&["drive"]));
    let (name, message) = one_error(load_scene(&desc));
    assert!(
        ["gltf-animation", "gltf-accessor", "gltf-index"].contains(&name),
        "{says}: {name}"
    );
    assert!(message.contains(says), "{says}: {message}");
    assert_says(&message, &["animation 0 \"drive\"", "m.glb"]);
}

#[test]
fn broken_animations_cannot_be_played_and_do_no_other_harm() {
    for (harm, says) in cases(include_str!("animation_names/broken_animations.txt")) {
        let mut doc = cart();
        doc.set(harm);
        assert_broken(&doc, says);
    }
    let nan = f32::NAN;
    for (times, says) in [
        (&[1.0, 0.5][..], "times must increase, but 0.5 follows 1"),
        (&[1.0, 1.0], "times must increase"),
        (&[-1.0, 1.0], "not negative"),
        (&[0.0, f32::INFINITY], "finite"),
        (&[nan, 1.0], "finite"),
        (&[0.0, 1.0, 2.0], "3 keys need 3 output values, there are 2"),
    ] {
        let mut doc = cart();
        sampler(&mut doc, "input", "SCALAR", times);
        assert_broken(&doc, says);
    }
    for (key, kind, values, says) in [
        (
            "output",
            "VEC3",
            &[0.0, 0.0, 0.0, 0.0, nan, 0.0][..],
            "output value 1",
        ),
        ("output", "VEC4", &[0.0; 8], "not allowed here"),
        ("input", "VEC3", &[0.0; 6], "not allowed here"),
    ] {
        let mut doc = cart();
        sampler(&mut doc, key, kind, values);
        assert_broken(&doc, says);
    }
    let mut doc = cart();
    doc.json["animations"][0]["channels"][0]["target"]["path"] = "rotation".into();
    sampler(&mut doc, "output", "VEC4", &[0.0; 8]);
    assert_broken(&doc, "rotation 0 is zero");
    let mut doc = cart();
    let integers = doc.accessor("SCALAR", 5123, 2, &[0, 0, 1, 0]);
    doc.json["animations"][0]["samplers"][0]["input"] = integers.into();
    assert_broken(&doc, "not allowed here");
}

/// Channels of an animation without the broken ones among them.
#[test]
fn a_broken_channel_stops_no_other() {
    let mut doc = cart();
    let good = doc.json["animations"][0]["channels"][0].clone();
    let mut lost = good.clone();
    lost["sampler"] = 9.into();
    for (channels, count) in [
        (json!([good, good]), "1 channels"),
        (json!([lost, good]), "1 channels"),
        (json!([{"sampler": "x"}, 3, good]), "2 channels"),
        (
            Value::Array([vec![lost.clone(); 100], vec![good.clone()]].concat()),
            "100 channels",
        ),
    ] {
        doc.json["animations"][0]["channels"] = channels;
        let (_folder, mut desc) = doc.scene();
        desc.models[0].value.animation = Some(playing(&["drive"]));
        let world = load_scene(&desc).expect("plays");
        assert_eq!(warnings(&world), ["animation-channel"]);
        assert!(
            world.warnings[0].message.starts_with(count),
            "{:?}",
            world.warnings[0]
        );
        assert_eq!(world.animations[0].channels, 1);
    }
    doc.json["animations"][0]["channels"] = Value::Array([vec![lost; 101], vec![good]].concat());
    assert_broken(&doc, "channel 0: sampler 9 does not exist");
}

/// Gives the first animation other times (`input`) or values (`output`).
fn sampler(doc: &mut Doc, key: &str, kind: &str, values: &[f32]) {
    let accessor = doc.floats(kind, values);
    doc.json["animations"][0]["samplers"][0][key] = accessor.into();
}

#[test]
fn what_is_not_played_is_named_when_it_is_asked_for() {
    let mut doc = cart();
    let target = |path: &str| json!({"sampler": 0, "target": {"node": 3, "path": path}});
    let spin = doc.json["animations"][0]["channels"][0].clone();
    doc.json["animations"][0]["channels"] = json!([spin, target("weights"), target("color"), {"sampler": 0, "target": {"path": "scale"}}]);
    doc.json["nodes"][4]["matrix"] = json!([2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 9, 0, 0, 1]);
    let (_folder, mut desc) = doc.scene();
    assert!(warnings(&load_scene(&desc).expect("it loads")).is_empty());
    desc.models[0].value.animation = Some(playing(&["drive"]));
    let world = posed(&desc, 24);
    assert_eq!(
        warnings(&world),
        [
            "animation-matrix",
            "animation-path",
            "animation-target",
            "animation-weights"
        ]
    );
    let (pose, _) = find(&world, "m/cart/box");
    // The matrix keeps its scale; its translation is the animation's.
    assert_near(
        pose,
        Affine3A::from_scale_rotation_translation(
            Vec3::splat(2.0),
            Quat::IDENTITY,
            Vec3::new(2.0, 0.0, 0.0),
        ),
    );
}

/// Animations of a bare model before it is loaded.
#[test]
fn file_lists_its_animations() {
    let folder = Folder::new();
    let path = folder.write("m.glb", cart().glb());
    let sandbox = gltf::Sandbox::new([folder.0.as_path()], 1 << 20);
    let path = path.canonicalize().expect("it is there");
    let playable = gltf::read(&path, &sandbox, &gltf::ReadOptions::default())
        .expect("it can be read")
        .playable();
    let found: Vec<_> = (playable.clips.iter())
        .map(|c| {
            (
                c.name.as_str(),
                c.animation.as_ref().map_or(0.0, |a| a.duration_s),
            )
        })
        .collect();
    assert_eq!(found, [("drive", 2.0), ("spin", 1.0), ("turn", 1.0)]);
    assert_eq!(playable.stage, None);
    let mut doc = cart();
    doc.json["scenes"][0]["extras"] = json!({"usd": {"timeCodesPerSecond": 30, "timeOrigin": 101,
        "startTimeCode": null, "endTimeCode": 150, "upAxis": "Y"}});
    folder.write("m.glb", doc.glb());
    let playable = gltf::read(&path, &sandbox, &gltf::ReadOptions::default())
        .expect("it can be read")
        .playable();
    let stage = playable.stage.expect("it was a stage");
    assert_eq!((stage.rate, stage.origin), (30.0, 101.0));
    assert_eq!(
        (stage.start_time_code, stage.end_time_code),
        (None, Some(150.0))
    );
}

/// Its timeline and geometry come from one read.
#[test]
fn a_model_that_was_read_for_its_timeline_is_not_read_again() {
    let folder = Folder::new();
    let path = folder.write("m.glb", cart().glb());
    let text = SceneText::read(Some(&path), &SceneOptions::default()).expect("it can be read");
    let opened = text.open(&[], &<_>::default()).expect("it is a scene");
    assert!(opened.scene.timeline.is_some());
    let (desc, options) = (opened.scene.desc.clone(), opened.options);
    folder.write("m.glb", "something else by now");
    let world = load::load(&desc, &options).expect("it was read before");
    assert!(!world.meshes.is_empty() && !world.moving.players.is_empty());
    assert_eq!(world.files, [path.canonicalize().expect("it is there")]);
    let errors = load::load(&desc, &options).expect_err("now it is read");
    assert!(errors[0].file.is_some(), "{}", errors[0]);
}
