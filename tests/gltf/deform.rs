//! Skins and morph targets: at rest, in the pose of the first frame after loading, and moving.

use glam::{DAffine3, DQuat, DVec3};
use reflet::scene::desc::TimelineDesc;

use crate::kit::*;

/// A triangle with two morph targets: the third corner up by 2 as all become red and their coordinates move, and all
/// corners towards the viewer.
fn morphed() -> Doc {
    let mut doc = Doc::triangle();
    let up = doc.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0]);
    let near = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let normals = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let tipped = doc.floats("VEC3", &[1.0, 0.0, 0.0].repeat(3));
    doc.attribute("NORMAL", normals);
    let red = doc.floats("VEC3", &[1.0, 0.0, 0.0].repeat(3));
    let black = doc.accessor("VEC4", 5121, 3, &[0, 0, 0, 255].repeat(3));
    doc.json["accessors"][black]["normalized"] = true.into();
    let uv = doc.floats("VEC2", &[0.25, 0.5].repeat(3));
    doc.attribute("COLOR_0", black);
    doc.attribute("TEXCOORD_0", uv);
    let first = json!({"POSITION": up, "NORMAL": tipped, "COLOR_0": red, "TEXCOORD_0": uv});
    doc.primitive("targets", json!([first, {"POSITION": near}]));
    doc
}

fn corners(world: &World, instance: usize) -> Vec<Vec3> {
    let instance = &world.instances[instance];
    let placed = world.posed(instance.mesh).positions.iter();
    placed
        .map(|p| instance.world_from_object.transform_point3(*p))
        .collect()
}

/// Morph targets of positions, normals, colors (COLOR_0) and texture coordinates (TEXCOORD_0).
#[test]
fn morph_targets_have_their_weights_at_rest() {
    let mut doc = morphed();
    assert_eq!(corners(&doc.world(), 0)[2], Vec3::Y, "no weights are zeros");
    doc.json["meshes"][0]["weights"] = json!([0.5, 0]);
    let world = doc.world();
    assert_eq!(corners(&world, 0)[2], Vec3::new(0.0, 2.0, 0.0));
    let normal = Vec3::new(0.5, 0.0, 1.0).normalize();
    assert!(world.meshes[0].normals[0].distance(normal) < 1e-6);
    assert_eq!(world.meshes[0].colors[2], Vec4::new(0.5, 0.0, 0.0, 1.0));
    assert_eq!(world.meshes[0].uv0[2], Vec2::new(0.375, 0.75));
    assert!(warnings(&world).is_empty());
    // A node's weights override the mesh's; another node shows the mesh with the mesh's own.
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
    assert_says(&message, &["target 0 POSITION has 2 elements"]);
    doc.primitive("targets", json!([{"POSITION": 99}]));
    assert_eq!(doc.error().0, "gltf-index");
}

/// Scene of a file in which `clip` plays, from this frame on at 10 frames per second.
pub fn played(folder: &Folder, doc: &Doc, start: u32) -> SceneDesc {
    folder.write("m.glb", doc.glb());
    let mut desc = scene(&folder.0, "m.glb");
    desc.models[0].value.animation = Some(AnimationDesc::endless(vec![unplaced("clip")]));
    desc.timeline = Some(TimelineDesc {
        fps: 10.0,
        start,
        end: 100,
    });
    desc
}

#[test]
fn animated_weights_begin_with_the_first_frame() {
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
        let (red, posed) = (1.0 - 0.05 * start as f32, world.posed(0));
        assert_eq!(posed.colors[2], Vec4::new(red, 0.0, 0.0, 1.0));
        assert_eq!(posed.uv0[2], Vec2::new(0.25, 0.5) * (1.0 + red));
        assert!(warnings(&world).is_empty());
        assert_eq!(world.animations[0].duration_s, 2.0);
    }
    // Without a played animation the mesh is at rest.
    assert_eq!(corners(&doc.world(), 0)[2], Vec3::Y);
    // Animation of the same weights by KHR_animation_pointer.
    let target = doc.json["animations"][0]["channels"][0]["target"].take();
    doc.json["animations"][0]["channels"][0]["target"] = json!({
        "path": "pointer",
        "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/0/weights"}}
    });
    let world = load_scene(&played(&folder, &doc, 10)).expect("loads");
    assert!(corners(&world, 0)[2].distance(Vec3::new(0.0, 2.0, 2.0)) < 1e-6);
    doc.json["animations"][0]["channels"][0]["target"] = target;
    doc.json["accessors"][times]["count"] = 1.into();
    let errors = load_scene(&played(&folder, &doc, 0)).expect_err("too many values");
    assert!(
        errors[0].message.contains("1 keys of 2 weights need 2"),
        "{errors:?}"
    );
}

/// A triangle skinned to one joint, which a clip moves from y = 2 to y = 4 in two seconds.
fn skinned() -> Doc {
    let mut doc = Doc::triangle();
    doc.hold_by_first_joint();
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
fn skins_begin_with_the_first_frame() {
    let doc = skinned();
    let folder = Folder::new();
    assert_eq!(corners(&doc.world(), 0)[0], Vec3::Y, "at rest");
    for (start, y) in [(0, 2.0), (10, 3.0)] {
        let world = load_scene(&played(&folder, &doc, start)).expect("loads");
        assert!(
            corners(&world, 0)[0].distance(Vec3::Y * y) < 1e-6,
            "frame {start}"
        );
        assert!(warnings(&world).is_empty());
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
    desc.instances[0].animation = Some(AnimationDesc::endless(Vec::new()));
    let world = load_scene(&desc).expect("loads");
    assert_eq!([0, 1].map(|i| corners(&world, i)[0].y), [1.0, 2.0]);
}

/// World of a scene with animations at a frame.
fn at_frame(desc: &SceneDesc, frame: u32) -> World {
    let mut world = load_scene(desc).expect("loads");
    let scene = Scene::from(desc.clone());
    let state = Animator::new(&scene).pose(frame).expect("poses");
    world.apply(&state).expect("applies");
    world
}

#[test]
fn skins_and_weights_move_with_the_timeline() {
    let folder = Folder::new();
    let mut desc = played(&folder, &skinned(), 0);
    let still = desc.models[0].value.animation.clone();
    desc.models[0].value.animation = None;
    desc.instances = vec![instance("m"), instance("m"), instance("m")];
    // One instance at rest, and two at different times.
    desc.instances[1].animation = still.clone();
    desc.instances[2].animation = still.map(|animation| AnimationDesc {
        start_s: 1.0,
        ..animation
    });
    for (frame, expected) in [(0, [1.0, 2.0, 2.0]), (15, [1.0, 3.5, 2.5])] {
        let world = at_frame(&desc, frame);
        for (i, y) in expected.into_iter().enumerate() {
            let found = corners(&world, i);
            let moved = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + Vec3::Y * y);
            let near = found.iter().zip(moved).all(|(a, b)| a.distance(b) < 1e-6);
            assert!(near, "frame {frame}, instance {i}: {found:?}");
            let bounds = world.bounds_of(&world.instances[i]);
            assert!((bounds.max.y - y - 1.0).abs() < 1e-6, "{bounds:?}");
        }
        assert_eq!(world.moving.deformers.len(), 2);
    }
    // The default camera frames all of the motion.
    desc.instances.truncate(2);
    let world = load_scene(&desc).expect("loads");
    let eye = &world.cameras[0].value;
    assert!((eye.target.y - 3.0).abs() < 0.5, "between 1 and 5: {eye:?}");
}

/// 200 vertices on random joints with random weights, and two morph targets, computed in f64 by the
/// specification's formula.
#[test]
fn posed_vertices_are_those_of_the_specification() {
    const COUNT: usize = 201;
    let mut random = crate::common::Random(7);
    let mut value = |from: f32, to: f32| {
        from + (to - from) * random.below(1 << 20) as f32 / (1u32 << 20) as f32
    };
    let positions: Vec<f32> = (0..COUNT * 3).map(|_| value(-1.0, 1.0)).collect();
    let offsets: Vec<f32> = (0..COUNT * 3).map(|_| value(-0.5, 0.5)).collect();
    let joints: Vec<u8> = (0..COUNT * 4).map(|_| value(0.0, 2.99) as u8).collect();
    let weights: Vec<f32> = (0..COUNT * 4).map(|_| value(0.0, 1.0)).collect();
    let mut doc = Doc::empty();
    let position = doc.floats("VEC3", &positions);
    let offset = doc.floats("VEC3", &offsets);
    let joint = doc.accessor("VEC4", 5121, COUNT, &joints);
    let weight = doc.floats("VEC4", &weights);
    doc.mesh(json!({
        "attributes": {"POSITION": position, "JOINTS_0": joint, "WEIGHTS_0": weight},
        "targets": [{"POSITION": offset}]
    }));
    let figure = doc.root_node(json!({"mesh": 0, "skin": 0}));
    let hip = doc.root_node(json!({"children": [2, 3], "translation": [0, 1, 0]}));
    doc.node(json!({"translation": [0.5, 0.5, 0], "scale": [1, 2, 1]}));
    doc.node(json!({"translation": [-0.5, 0, 0.25]}));
    doc.json["skins"] = json!([{"joints": [hip, 2, 3]}]);
    let times = doc.floats("SCALAR", &[0.0, 1.0]);
    let turn = doc.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8]);
    let grow = doc.floats("SCALAR", &[0.0, 2.0]);
    doc.json["animations"] = json!([{
        "name": "clip",
        "samplers": [{"input": times, "output": turn}, {"input": times, "output": grow}],
        "channels": [
            {"sampler": 0, "target": {"node": 2, "path": "rotation"}},
            {"sampler": 1, "target": {"node": figure, "path": "weights"}}
        ]
    }]);
    let folder = Folder::new();
    let world = at_frame(&played(&folder, &doc, 0), 5);

    let half_angle = 0.6_f64.asin() * 0.5;
    let bent = DAffine3::from_scale_rotation_translation(
        DVec3::new(1.0, 2.0, 1.0),
        DQuat::from_rotation_y(2.0 * half_angle),
        DVec3::new(0.5, 0.5, 0.0),
    );
    let up = DAffine3::from_translation(DVec3::Y);
    let side = DAffine3::from_translation(DVec3::new(-0.5, 0.0, 0.25));
    let joint = [up, up * bent, up * side];
    let wide = |values: &[f32], i: usize| -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| f64::from(values[3 * i + k])))
    };
    // The mesh has no normals, so that each triangle has vertices of its own.
    let found = &world.posed(world.instances[0].mesh);
    let diagonal = found.bounds.diagonal();
    assert_eq!(found.positions.len(), COUNT);
    for (i, found) in found.positions.iter().enumerate() {
        let bound = wide(&positions, i) + wide(&offsets, i);
        let of = |k: usize| f64::from(weights[4 * i + k]);
        let sum: f64 = (0..4).map(of).sum();
        let moved = (0..4)
            .map(|k| joint[usize::from(joints[4 * i + k])].transform_point3(bound) * of(k) / sum);
        let expected: DVec3 = moved.sum();
        let error = found.as_dvec3().distance(expected) as f32;
        assert!(error < 1e-6 * diagonal, "{i}: {error} of {diagonal}");
    }
    for (t, normal) in found.normals.chunks_exact(3).enumerate() {
        let [a, b, c] = [0, 1, 2].map(|k| found.positions[3 * t + k]);
        let expected = (b - a).cross(c - a).normalize();
        assert!(normal[0].dot(expected) > 0.999_99, "triangle {t}");
    }
}

#[test]
fn poses_that_are_not_finite_are_named() {
    let mut doc = skinned();
    let huge = doc.floats("VEC3", &[0.0, 0.0, 0.0, 3e38, 3e38, 3e38]);
    let twice = doc.floats("VEC4", &[0.9, 0.9, 0.0, 0.0].repeat(3));
    doc.attribute("WEIGHTS_0", twice);
    doc.json["animations"][0]["samplers"][0]["output"] = huge.into();
    let folder = Folder::new();
    let desc = played(&folder, &doc, 0);
    let mut world = load_scene(&desc).expect("the first frame is fine");
    let before = corners(&world, 0);
    let scene = Scene::from(desc);
    let state = Animator::new(&scene).pose(19).expect("poses");
    let errors = world.apply(&state).expect_err("too far");
    assert_eq!(errors[0].name, "bad-pose");
    assert_eq!(corners(&world, 0), before);
}

/// A joint places a skinned mesh, its own node hides it.
#[test]
fn skinned_meshes_are_hidden_by_their_nodes() {
    let mut doc = skinned();
    let times = doc.floats("SCALAR", &[0.0, 1.0]);
    let shown = doc.accessor("SCALAR", 5121, 2, &[1, 0]);
    let animation = &mut doc.json["animations"][0];
    let samplers = animation["samplers"].as_array_mut().expect("a list");
    samplers.push(json!({"input": times, "output": shown, "interpolation": "STEP"}));
    let channels = animation["channels"].as_array_mut().expect("a list");
    let pointer = "/nodes/0/extensions/KHR_node_visibility/visible";
    channels.push(json!({"sampler": 1, "target": {
        "path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}
    }}));
    doc.json["nodes"][0]["translation"] = json!([9, 9, 9]);
    let folder = Folder::new();
    let desc = played(&folder, &doc, 0);
    let world = at_frame(&desc, 5);
    assert!(corners(&world, 0)[0].distance(Vec3::Y * 2.5) < 1e-6);
    assert!(at_frame(&desc, 15).instances[0].is_hidden());
}
