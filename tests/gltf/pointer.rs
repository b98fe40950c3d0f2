//! KHR_animation_pointer: animated materials, textures, lights and cameras.

use glam::Vec2;
use reflet::{
    scene::desc::LightKind,
    world::{TextureRef, load},
};

use crate::kit::*;

/// A file with an animation of 2 s. Each line has a pointer, the type of its values, and the first and the last value.
fn doc(pointers: &str) -> Doc {
    let mut doc = Doc::triangle();
    doc.json["materials"] = json!([
        {"name": "lamp", "emissiveFactor": [1, 0.5, 0],
         "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}},
         "pbrMetallicRoughness": {"metallicFactor": 0, "baseColorTexture": {"index": 0, "texCoord": 1,
            "extensions": {"KHR_texture_transform": {"scale": [2, 4]}}}}}
    ]);
    let png = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==";
    doc.json["images"] = json!([{"uri": png}]);
    doc.json["textures"] = json!([{"source": 0}]);
    doc.primitive("material", json!(0));
    let uv = doc.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    doc.attribute("TEXCOORD_1", uv);
    doc.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "spot": {"outerConeAngle": 0.5}}]}});
    doc.json["cameras"] = json!([
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 1}}]);
    doc.root_node(json!({"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    let times = doc.floats("SCALAR", &[0.0, 2.0]);
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for line in pointers.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [pointer, form, first, last] = words[..] else {
            panic!("{line}");
        };
        let numbers = [first, last].map(|value| value.split(',').map(|n| n.parse().expect(n)));
        let output = doc.floats(form, &numbers.into_iter().flatten().collect::<Vec<f32>>());
        channels.push(
            json!({"sampler": samplers.len(), "target": {"path": "pointer",
            "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}}),
        );
        samplers.push(json!({"input": times, "output": output}));
    }
    doc.json["animations"] = json!([{"name": "clip", "samplers": samplers, "channels": channels}]);
    doc
}

/// World of a file whose clip plays, halfway through it.
fn halfway(folder: &Folder, doc: &Doc) -> World {
    let desc = crate::deform::played(folder, doc, 0);
    let mut world = load::load(&desc, &load::LoadOptions::default()).expect("loads");
    let scene = Scene::from(desc);
    let state = Animator::new(&scene).pose(10).expect("poses");
    world.apply(&state).expect("applies");
    world
}

#[test]
fn materials_textures_lights_and_cameras_change() {
    let folder = Folder::new();
    let doc = doc(include_str!("pointers.txt"));
    let world = halfway(&folder, &doc);
    let material = &world.materials[world.instances[0].material];
    assert_eq!(material.base_color.truncate(), Vec3::new(0.5, 0.5, 0.0));
    assert_eq!((material.metallic, material.roughness), (0.0, 0.5));
    assert_eq!(material.emission, Vec3::new(4.0, 2.0, 0.0));
    assert_eq!(material.alpha_cutoff, None, "it is opaque");
    let texture = material.base_color_texture.expect("a texture");
    let rows = TextureRef::rows(Vec2::new(0.5, 1.5), 0.0, Vec2::new(2.0, 4.0));
    assert_eq!((texture.transform, texture.uv_set), (rows, 1));
    let light = &world.lights[0].desc;
    assert_eq!(light.color, Vec3::new(0.5, 0.25, 1.0));
    assert_eq!(light.kind.intensity(), 20.0);
    let LightKind::Spot { outer_deg, .. } = light.kind else {
        panic!("{light:?}")
    };
    assert!(
        (outer_deg - 0.75_f32.to_degrees()).abs() < 1e-3,
        "{outer_deg}"
    );
    assert_eq!(world.cameras[0].value.orthographic_height_m, Some(4.0));
    assert_eq!(warnings(&world), [""; 0]);
}

#[test]
fn what_a_pointer_cannot_change_is_named() {
    let folder = Folder::new();
    let unknown = "/materials/0/extensions/KHR_materials_sss/scatterDistance SCALAR 0 1
                   /cameras/0/orthographic/ymag SCALAR 1 3";
    let world = halfway(&folder, &doc(unknown));
    assert_eq!(warnings(&world), ["animation-pointer"]);
    for (pointer, says) in cases(include_str!("pointer/broken.txt")) {
        let broken = doc(&format!("{pointer} 0,0,0 0,0,0"));
        folder.write("m.glb", broken.glb());
        let mut desc = scene(&folder.0, "m.glb");
        desc.models[0].value.animation = Some(AnimationDesc::endless(vec![unplaced("clip")]));
        let errors = load::load(&desc, &load::LoadOptions::default()).expect_err("broken");
        let message = errors[0].to_string();
        assert!(message.contains(says), "{pointer}: {message}");
    }
}
