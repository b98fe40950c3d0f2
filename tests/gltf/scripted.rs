//! Scripted poses of nodes and morph targets.

use reflet::{
    scene::motion::{FrameState, JointPose},
    world::load,
};

use crate::kit::*;

/// A triangle with two morph targets on a joint, below another joint; the second target has no name.
fn doc() -> Doc {
    let mut doc = Doc::triangle();
    let up = doc.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
    let near = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    doc.primitive("targets", json!([{"POSITION": up}, {"POSITION": near}]));
    doc.hold_by_first_joint();
    doc.json["meshes"][0]["extras"] = json!({"targetNames": ["up"]});
    doc.json["meshes"][0]["weights"] = json!([0.5, 0]);
    doc.json["skins"] = json!([{"joints": [2]}]);
    doc.json["nodes"] = json!([
        {"mesh": 0, "skin": 0},
        {"name": "arm", "translation": [5, 0, 0], "children": [2]},
        {"name": "hand", "rotation": [0, 0, 1, 1], "children": [3]},
        {"name": "ring", "mesh": 1, "translation": [0, 1, 0]}
    ]);
    let mut ring = doc.json["meshes"][0].clone();
    ring["weights"] = json!([]);
    ring["primitives"][0]["targets"] = json!([]);
    doc.json["meshes"] = json!([doc.json["meshes"][0], ring]);
    doc.json["scenes"][0]["nodes"] = json!([0, 1]);
    doc
}

const SCENE: &str = include_str!("scripted/scene.toml");

fn loaded(folder: &Folder, text: &str) -> Result<(Scene, World), String> {
    folder.write("m.glb", doc().glb());
    let (scene, _) = Scene::from_text(text, &folder.0.join("scene.toml"), &[])
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<String>())?;
    let world = load::load(&scene, &load::LoadOptions::default())
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<String>())?;
    Ok((scene, world))
}

/// Third vertex of an instance's triangle.
fn third(world: &World, instance: usize) -> Vec3 {
    let instance = &world.instances[instance];
    let position = world.posed(instance.mesh).positions[2];
    instance.world_from_object.transform_point3(position)
}

#[test]
fn joints_and_weights_are_those_of_the_script() {
    let folder = Folder::new();
    let (scene, mut world) = loaded(&folder, SCENE).expect("loads");
    let rest = Animator::new(&scene).pose(0).expect("poses");
    world.apply(&rest).expect("applies");
    // The rest position (0, 1 + 0.5 · 2, 0) is rotated to −X and moved by 5; the ring is a child there, unmorphed.
    let close = |found: Vec3, x, y, z| {
        assert!(
            found.distance(Vec3::new(x, y, z)) < 1e-5,
            "{found}, {x} {y} {z}"
        );
    };
    close(third(&world, 0), 3.0, 0.0, 0.0);
    close(third(&world, 1), 3.0, 0.0, 0.0);
    let state = FrameState {
        joints: [
            (
                (0, 0),
                JointPose {
                    rotation: Some(Quat::IDENTITY),
                    ..JointPose::default()
                },
            ),
            (
                (0, 1),
                JointPose {
                    translation: Some(Vec3::Y),
                    scale: Some(Vec3::splat(2.0)),
                    ..JointPose::default()
                },
            ),
        ]
        .into(),
        morphs: [((0, 0), 0.0), ((0, 1), 3.0)].into(),
        ..rest.clone()
    };
    world.apply(&state).expect("applies");
    close(third(&world, 0), 0.0, 3.0, 6.0);
    close(third(&world, 1), 0.0, 5.0, 0.0);
    // The other instance is unchanged, and so is this one in a frame without a pose of the script.
    close(third(&world, 2), 3.0, 0.0, 9.0);
    let turned = FrameState {
        joints: [(
            (0, 0),
            JointPose {
                turn: Some(Quat::from_rotation_z(std::f32::consts::PI)),
                ..JointPose::default()
            },
        )]
        .into(),
        ..rest.clone()
    };
    world.apply(&turned).expect("applies");
    close(third(&world, 0), 7.0, 0.0, 0.0);
    world.apply(&rest).expect("applies");
    close(third(&world, 0), 3.0, 0.0, 0.0);
    let huge = FrameState {
        morphs: [((0, 1), f32::MAX)].into(),
        joints: [(
            (0, 1),
            JointPose {
                scale: Some(Vec3::splat(1e30)),
                ..JointPose::default()
            },
        )]
        .into(),
        ..rest
    };
    assert_eq!(
        world.apply(&huge).expect_err("not finite")[0].name,
        "bad-pose"
    );
}

#[test]
fn names_that_the_file_does_not_have_are_errors() {
    let folder = Folder::new();
    for (old, new, says) in [
        ("\"hand\"", "\"hands\"", "did you mean \"hand\"?"),
        ("\"hand\"", "\"xyz\"", "its nodes are arm, hand, ring"),
        ("\"up\"", "\"uq\"", "its morph targets are 1, up"),
        ("\"1\"", "\"2\"", "has no morph target \"2\""),
        (
            "joints = [\"hand\", \"arm\"]",
            "joints = [7]",
            "text in quotes",
        ),
        (
            "file = \"m.glb\"",
            "shape = { kind = \"sphere\" }",
            "a shape has no node",
        ),
    ] {
        let errors = loaded(&folder, &SCENE.replace(old, new)).expect_err("an error");
        assert_says(&errors, &[says, "scene.toml:"]);
    }
}
