//! Skins and morph targets in the one pose that they have: that of the scene's first frame.

use crate::kit::{Doc, Folder, at, instance, load_scene, one_error, scene, warnings};
use glam::Vec3;
use reflet::{
    scene::desc::{AnimationDesc, SceneDesc, TimelineDesc},
    world::World,
};
use serde_json::json;

/// A triangle with two targets: the third corner up by 2, and all corners towards the viewer.
fn morphed() -> Doc {
    let mut doc = Doc::triangle();
    let up = doc.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
    let near = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let normals = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let tipped = doc.floats("VEC3", &[1.0, 0.0, 0.0].repeat(3));
    doc.attribute("NORMAL", normals);
    doc.primitive(
        "targets",
        json!([{"POSITION": up, "NORMAL": tipped}, {"POSITION": near}]),
    );
    doc
}

fn corners(world: &World, instance: usize) -> Vec<Vec3> {
    let instance = &world.instances[instance];
    let mesh = &world.meshes[instance.mesh];
    let placed = mesh.positions.iter();
    placed
        .map(|p| instance.world_from_object.transform_point3(*p))
        .collect()
}

#[test]
fn morph_targets_have_their_weights_at_rest() {
    let mut doc = morphed();
    assert_eq!(corners(&doc.world(), 0)[2], Vec3::Y, "no weights are zeros");
    doc.json["meshes"][0]["weights"] = json!([0.5, 0]);
    let world = doc.world();
    assert_eq!(corners(&world, 0)[2], Vec3::new(0.0, 2.0, 0.0));
    let normal = Vec3::new(0.5, 0.0, 1.0).normalize();
    assert!(world.meshes[0].normals[0].distance(normal) < 1e-6);
    assert!(warnings(&world).is_empty());
    // A node's weights win; another node shows the mesh with its own.
    doc.json["nodes"][0]["weights"] = json!([0, 2]);
    doc.root_node(json!({"mesh": 0}));
    let world = doc.world();
    assert_eq!(
        corners(&world, 0),
        [
            Vec3::Z * 2.0,
            Vec3::new(1.0, 0.0, 2.0),
            Vec3::new(0.0, 1.0, 2.0)
        ]
    );
    assert_eq!(corners(&world, 1)[2], Vec3::new(0.0, 2.0, 0.0));
}

#[test]
fn broken_targets_are_named() {
    let mut doc = morphed();
    doc.json["meshes"][0]["weights"] = json!([1, 1]);
    let short = doc.floats("VEC3", &[0.0; 6]);
    doc.primitive("targets", json!([{"POSITION": short}]));
    let (name, message) = one_error(doc.load());
    assert_eq!(name, "gltf-attribute");
    assert!(
        message.contains("target 0 POSITION has 2 elements"),
        "{message}"
    );
    doc.primitive("targets", json!([{"POSITION": 99}]));
    assert_eq!(doc.error().0, "gltf-index");
}

/// The scene of a file in which `clip` is played, from this frame on at 10 frames a second.
fn played(folder: &Folder, doc: &Doc, start: u32) -> SceneDesc {
    folder.write("m.glb", doc.glb());
    let mut desc = scene(&folder.0, "m.glb");
    desc.models[0].value.animation = Some(AnimationDesc::of(vec![at("clip")]));
    desc.timeline = Some(TimelineDesc {
        fps: 10.0,
        start,
        end: 100,
    });
    desc
}

#[test]
fn animated_weights_are_those_of_the_first_frame() {
    let mut doc = morphed();
    let times = doc.floats("SCALAR", &[0.0, 2.0]);
    let weights = doc.floats("SCALAR", &[1.0, 0.0, 0.0, 4.0]);
    doc.json["animations"] = json!([{
        "name": "clip", "samplers": [{"input": times, "output": weights}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]
    }]);
    let folder = Folder::new();
    for (start, expected) in [
        (0, Vec3::new(0.0, 3.0, 0.0)),
        (10, Vec3::new(0.0, 2.0, 2.0)),
    ] {
        let world = load_scene(&played(&folder, &doc, start)).expect("loads");
        assert!(
            corners(&world, 0)[2].distance(expected) < 1e-6,
            "frame {start}"
        );
        assert_eq!(warnings(&world), ["animation-weights"]);
        assert_eq!(world.animations[0].duration_s, 2.0);
    }
    // Not played: at rest.
    assert_eq!(corners(&doc.world(), 0)[2], Vec3::Y);
    doc.json["accessors"][times]["count"] = 1.into();
    let errors = load_scene(&played(&folder, &doc, 0)).expect_err("too many values");
    assert!(
        errors[0].message.contains("1 keys of 2 weights need 2"),
        "{errors:?}"
    );
}

/// A triangle that hangs on one joint, which a clip moves from y = 2 to y = 4 in two seconds.
fn skinned() -> Doc {
    let mut doc = Doc::triangle();
    let joints = doc.accessor("VEC4", 5121, 3, &[0; 12]);
    let weights = doc.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    doc.attribute("JOINTS_0", joints);
    doc.attribute("WEIGHTS_0", weights);
    let bone = doc.root_node(json!({"name": "bone", "translation": [0, 1, 0]}));
    doc.json["skins"] = json!([{"joints": [bone]}]);
    doc.json["nodes"][0]["skin"] = 0.into();
    let times = doc.floats("SCALAR", &[0.0, 2.0]);
    let moves = doc.floats("VEC3", &[0.0, 2.0, 0.0, 0.0, 4.0, 0.0]);
    doc.json["animations"] = json!([{
        "name": "clip", "samplers": [{"input": times, "output": moves}],
        "channels": [{"sampler": 0, "target": {"node": bone, "path": "translation"}}]
    }]);
    doc
}

#[test]
fn skins_are_in_the_pose_of_the_first_frame() {
    let doc = skinned();
    let folder = Folder::new();
    assert_eq!(corners(&doc.world(), 0)[0], Vec3::Y, "at rest");
    for (start, y) in [(0, 2.0), (10, 3.0)] {
        let world = load_scene(&played(&folder, &doc, start)).expect("loads");
        assert!(
            corners(&world, 0)[0].distance(Vec3::Y * y) < 1e-6,
            "frame {start}"
        );
        assert_eq!(warnings(&world), ["skin-rest-pose"]);
        assert_eq!(world.meshes.len(), 1);
    }
    // Two models of one file in different poses; an instance's own animation counts.
    let mut desc = played(&folder, &doc, 0);
    let mut still = desc.models[0].clone();
    still.name = "still".to_owned();
    still.value.animation = None;
    desc.models.push(still);
    desc.instances = vec![instance("m"), instance("still")];
    let world = load_scene(&desc).expect("loads");
    assert_eq!([0, 1].map(|i| corners(&world, i)[0].y), [2.0, 1.0]);
    desc.instances[1].animation = desc.models[0].value.animation.clone();
    desc.instances[0].animation = Some(AnimationDesc::of(Vec::new()));
    let world = load_scene(&desc).expect("loads");
    assert_eq!([0, 1].map(|i| corners(&world, i)[0].y), [1.0, 2.0]);
}
