//! Animations of glTF files: poses, timing, and errors of invalid ones.

use glam::{Affine3A, EulerRot};
use reflet::scene::desc::{LightKind, Playback, RepeatDesc, TimelineDesc};

use crate::kit::*;

/// Adds an animation of one channel.
pub fn animate(doc: &mut Doc, name: &str, node: usize, path: &str, keys: &[(f32, &[f32])]) {
    let (sampler, channel) = channel(doc, node, path, keys);
    doc.json["animations"]
        .as_array_mut()
        .expect("a list")
        .push(json!({"name": name, "samplers": [sampler], "channels": [channel]}));
}

pub fn channel(doc: &mut Doc, node: usize, path: &str, keys: &[(f32, &[f32])]) -> (Value, Value) {
    let times: Vec<f32> = keys.iter().map(|(t, _)| *t).collect();
    let values: Vec<f32> = keys.iter().flat_map(|(_, v)| v.iter().copied()).collect();
    let kind = if path == "rotation" { "VEC4" } else { "VEC3" };
    let (input, output) = (doc.floats("SCALAR", &times), doc.floats(kind, &values));
    (
        json!({"input": input, "output": output}),
        json!({"sampler": 0, "target": {"node": node, "path": path}}),
    )
}

/// A cart that moves, with a wheel that rotates on it, a still wall, a lamp and a camera on the cart.
pub fn cart() -> Doc {
    let mut doc = Doc::triangle(); // node 0 "wall", mesh 0
    doc.json["animations"] = json!([]);
    doc.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 5, "spot": {"outerConeAngle": 0.5}}
    ]}});
    doc.json["cameras"] = json!([
        {"name": "eye", "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}
    ]);
    let wheel = doc.node(json!({"name": "wheel", "mesh": 0, "translation": [0, 1, 0]}));
    let lamp = doc.node(
        json!({"name": "lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}, "camera": 0}),
    );
    let box_ = doc.node(json!({"name": "box", "mesh": 0}));
    let cart = doc.root_node(json!({"name": "cart", "children": [wheel, lamp, box_]}));
    animate(
        &mut doc,
        "drive",
        cart,
        "translation",
        &[(0.0, &[0.0; 3]), (2.0, &[4.0, 0.0, 0.0])],
    );
    let half = std::f32::consts::FRAC_1_SQRT_2;
    animate(
        &mut doc,
        "spin",
        wheel,
        "rotation",
        &[(0.0, &[0.0, 0.0, 0.0, 1.0]), (1.0, &[0.0, 0.0, half, half])],
    );
    animate(
        &mut doc,
        "turn",
        cart,
        "rotation",
        &[(0.0, &[0.0, 0.0, 0.0, 1.0]), (1.0, &[0.0, half, 0.0, half])],
    );
    doc
}

pub fn playing(names: &[&str]) -> AnimationDesc {
    AnimationDesc::endless(names.iter().map(|name| unplaced(name)).collect())
}

/// Scene of the cart at 24 frames per second, whose model plays these animations.
pub fn cart_scene(names: &[&str]) -> (Folder, SceneDesc) {
    let folder = Folder::new();
    folder.write("m.glb", cart().glb());
    let mut desc = scene(&folder.0, "m.glb");
    desc.models[0].value.animation = Some(playing(names));
    desc.timeline = Some(TimelineDesc {
        fps: 24.0,
        start: 0,
        end: 96,
    });
    (folder, desc)
}

/// World at a frame, for a scene without a script.
pub fn posed(desc: &SceneDesc, frame: u32) -> World {
    posed_scene(&desc.clone().into(), frame)
}

/// World at a frame.
pub fn posed_scene(scene: &Scene, frame: u32) -> World {
    let mut world = load_scene(scene).expect("valid");
    let state = Animator::new(scene).pose(frame).expect("it can be posed");
    world.apply(&state).expect("valid");
    world
}

pub fn find(world: &World, name: &str) -> (Affine3A, bool) {
    let found = world.instances.iter().find(|i| i.name == name);
    let found = found.unwrap_or_else(|| {
        let names: Vec<_> = world.instances.iter().map(|i| &i.name).collect();
        panic!("{name} is not in {names:?}")
    });
    (found.world_from_object, found.dynamic)
}

#[track_caller]
pub fn assert_near(a: Affine3A, b: Affine3A) {
    assert!(a.abs_diff_eq(b, 1e-5), "{a:?}\nis not\n{b:?}");
}

#[test]
fn only_what_an_animation_moves_is_dynamic() {
    let (_folder, mut desc) = cart_scene(&["drive"]);
    let world = posed(&desc, 24);
    let cart = Affine3A::from_translation(Vec3::new(2.0, 0.0, 0.0));
    assert_eq!(find(&world, "m/wall"), (Affine3A::IDENTITY, false));
    assert_near(find(&world, "m/cart/box").0, cart);
    let up = Affine3A::from_translation(Vec3::Y);
    assert_near(find(&world, "m/cart/wheel").0, cart * up);
    assert!(find(&world, "m/cart/wheel").1);
    assert!(warnings(&world).is_empty());
    // The animation of the wheel alone.
    desc.models[0].value.animation = Some(playing(&["spin"]));
    let world = posed(&desc, 12);
    assert_eq!(find(&world, "m/cart/box"), (Affine3A::IDENTITY, false));
    let turn = Affine3A::from_rotation_z(std::f32::consts::FRAC_PI_4);
    assert_near(find(&world, "m/cart/wheel").0, up * turn);
    // All animations at once: a rotating wheel on a rotating cart.
    desc.models[0].value.animation = Some(playing(&["*"]));
    let world = posed(&desc, 12);
    let cart = Affine3A::from_translation(Vec3::X) * Affine3A::from_rotation_y(turn_y(0.5));
    assert_near(find(&world, "m/cart/wheel").0, cart * up * turn);
    // No animation at all.
    for none in [None, Some(playing(&[]))] {
        desc.models[0].value.animation = none;
        assert!(desc.is_still());
        let world = posed(&desc, 12);
        assert!(world.instances.iter().all(|i| !i.dynamic));
        assert_eq!(world.animations.len(), 3, "but they are listed");
        assert!(
            world
                .animations
                .iter()
                .all(|a| !a.played && a.channels == 1)
        );
    }
}

fn turn_y(share: f32) -> f32 {
    std::f32::consts::FRAC_PI_2 * share
}

#[test]
fn lights_and_cameras_follow_their_nodes() {
    let (_folder, desc) = cart_scene(&["drive", "turn"]);
    let world = posed(&desc, 12);
    let cart = Affine3A::from_translation(Vec3::X) * Affine3A::from_rotation_y(turn_y(0.5));
    let LightKind::Spot {
        position,
        direction,
        ..
    } = world.lights[0].desc.kind
    else {
        panic!("{:?}", world.lights)
    };
    assert!(
        position.distance(cart.translation.into()) < 1e-5,
        "{position}"
    );
    let forward = cart.transform_vector3(Vec3::NEG_Z);
    assert!(direction.distance(forward) < 1e-5, "{direction}");
    let eye = &world.cameras[0].value;
    assert!(eye.eye.distance(cart.translation.into()) < 1e-5);
    assert!((eye.target - eye.eye).distance(forward) < 1e-5);
}

#[test]
fn lights_and_cameras_follow_moving_instances() {
    let (_folder, mut desc) = cart_scene(&[]);
    desc.models[0].value.animation = None;
    desc.instances = vec![InstanceDesc {
        name: Some("it".into()),
        dynamic: true,
        ..instance("m")
    }];
    let mut world = load_scene(&desc).expect("it loads");
    let mut state = Animator::new(&desc.clone().into())
        .pose(0)
        .expect("it can be posed");
    let moved = Affine3A::from_rotation_translation(
        Quat::from_euler(EulerRot::XYZ, 0.3, 1.0, -0.4),
        Vec3::new(1.0, 2.0, 3.0),
    );
    state.instances[0] = moved;
    world.apply(&state).expect("it is a pose");
    let LightKind::Spot { position, .. } = world.lights[0].desc.kind else {
        panic!("{:?}", world.lights)
    };
    assert!(position.distance(Vec3::new(1.0, 2.0, 3.0)) < 1e-5);
    let up = world.cameras[0].value.up;
    assert!(up.distance(moved.transform_vector3(Vec3::Y)) < 1e-5, "{up}");
    // A hidden instance takes them along.
    world.leave_out(&[].into(), &[].into(), |light| light.written == Some(0));
    assert_eq!(world.lights[0].desc.color, Vec3::ZERO);
}

#[test]
fn instances_of_one_file_play_different_animations() {
    let (_folder, mut desc) = cart_scene(&["drive"]);
    let named = |name: &str, animation: Option<AnimationDesc>| InstanceDesc {
        name: Some(name.into()),
        placement: trs(Vec3::Z),
        animation,
        ..instance("m")
    };
    let late = AnimationDesc {
        start_s: 0.5,
        speed: 2.0,
        repeat: Playback::Once,
        ..playing(&["drive"])
    };
    desc.instances = vec![
        named("a", None),
        named("b", Some(late)),
        named("c", Some(playing(&["spin"]))),
        named("d", Some(playing(&[]))),
    ];
    desc.instances[0].repeat = Some(RepeatDesc {
        count: [2, 1, 1],
        step: Vec3::new(10.0, 0.0, 0.0),
    });
    let world = posed(&desc, 24);
    let x = |name: &str| find(&world, name).0.translation;
    assert!((x("a[0,0,0]/cart/box") - glam::Vec3A::new(2.0, 0.0, 1.0)).length() < 1e-5);
    assert!((x("a[1,0,0]/cart/box") - glam::Vec3A::new(12.0, 0.0, 1.0)).length() < 1e-5);
    assert!((x("b/cart/box") - glam::Vec3A::new(2.0, 0.0, 1.0)).length() < 1e-5);
    assert!(!find(&world, "c/cart/box").1 && find(&world, "c/cart/wheel").1);
    assert!(
        world
            .instances
            .iter()
            .all(|i| !i.name.starts_with("d/") || !i.dynamic)
    );
    let world = posed(&desc, 60); // 2.5 s: the loop is at 0.5 s, the other at its end
    let x = |name: &str| find(&world, name).0.translation.x;
    assert!((x("a[0,0,0]/cart/box") - 1.0).abs() < 1e-5);
    assert!((x("b/cart/box") - 4.0).abs() < 1e-5);
    // A time set by a script overrides the animation's own.
    let mut world = load_scene(&desc).expect("it loads");
    let mut state = Animator::new(&desc.clone().into())
        .pose(0)
        .expect("it can be posed");
    state.animation_s[1] = Some(0.25);
    world.apply(&state).expect("it is a pose");
    assert!((find(&world, "b/cart/box").0.translation.x - 0.5).abs() < 1e-5);
    assert_eq!(find(&world, "a[0,0,0]/cart/box").0.translation.x, 0.0);
}

#[test]
fn copies_of_a_node_move_with_it() {
    let mut doc = cart();
    let offsets = doc.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 5.0]);
    doc.json["nodes"][1]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": offsets}}});
    let (_folder, mut desc) = doc.scene();
    desc.models[0].value.animation = Some(playing(&["spin"]));
    let world = posed(&desc, 12);
    let turn = Affine3A::from_rotation_z(std::f32::consts::FRAC_PI_4);
    let wheel = Affine3A::from_translation(Vec3::Y) * turn;
    assert_near(find(&world, "m/cart/wheel[0]").0, wheel);
    let copy = Affine3A::from_translation(Vec3::new(0.0, 0.0, 5.0));
    assert_near(find(&world, "m/cart/wheel[1]").0, wheel * copy);
}

#[test]
fn rotations_may_be_small_integers() {
    for (component, bytes) in [
        (5120, vec![0u8, 0, 0, 127, 0, 90, 0, 90]),
        (5121, vec![0, 0, 0, 255, 0, 180, 0, 180]),
        (
            5122,
            [0i16, 0, 0, 32767, 0, 23170, 0, 23170]
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect(),
        ),
        (
            5123,
            [0u16, 0, 0, 65535, 0, 46341, 0, 46341]
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect(),
        ),
    ] {
        let mut doc = cart();
        let output = doc.accessor("VEC4", component, 2, &bytes);
        doc.json["accessors"][output]["normalized"] = true.into();
        doc.json["animations"][2]["samplers"][0]["output"] = output.into();
        let (_folder, mut desc) = doc.scene();
        desc.models[0].value.animation = Some(playing(&["turn"]));
        let (pose, _) = find(&posed(&desc, 12), "m/cart/box");
        assert_near(pose, Affine3A::from_rotation_y(turn_y(0.5)));
    }
}
