//! Lights, cameras, placements and files of glTF in a scene.

use glam::Affine3A;
use reflet::scene::desc::{
    BevelDesc, InstanceMaterialDesc, LightKind, MaterialDesc, ModelDesc, ModelSource, RepeatDesc,
    ShapeDesc, StageDesc,
};

use crate::kit::*;

fn cube() -> ShapeDesc {
    ShapeDesc::Box {
        size: Vec3::ONE,
        bevel: BevelDesc::default(),
    }
}

fn shape(shape: ShapeDesc, material: Option<&str>) -> ModelDesc {
    let source = ModelSource::Shape(shape);
    ModelDesc {
        source,
        material: material.map(unplaced),
        overrides: Vec::new(),
        lights: true,
        variant: None,
        animation: None,
        usd: StageDesc::default(),
    }
}

fn lights_and_cameras() -> Doc {
    let mut doc = Doc::triangle();
    doc.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 40, "color": [1, 0.5, 0.25], "range": 7,
         "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
        {"type": "directional"}, {"type": "point"}
    ]}});
    doc.json["cameras"] = json!([
        {"name": "eye", "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.5}},
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1.5, "zfar": 1, "znear": 0}}
    ]);
    let spot = json!({"KHR_lights_punctual": {"light": 0}});
    doc.root_node(
        json!({"name": "lamp", "translation": [0, 4, 0], "rotation": [-1, 0, 0, 1],
                         "scale": [3, 3, 3], "extensions": spot, "camera": 0}),
    );
    doc.root_node(json!({"extensions": {"KHR_lights_punctual": {"light": 1}}, "camera": 1}));
    doc
}

#[test]
fn a_light_with_a_mistake_does_not_take_the_file() {
    let spot = |inner: f32, outer: f32| json!({"type": "spot", "spot": {"innerConeAngle": inner, "outerConeAngle": outer}});
    for (light, inner_deg, name) in [
        (
            spot(0.5, 0.5),
            Some(0.999_f32 * 0.5_f32.to_degrees()),
            "light-clamped",
        ),
        (
            spot(1.0, 0.5),
            Some(0.999 * 0.5_f32.to_degrees()),
            "light-clamped",
        ),
        (spot(-1.0, 0.5), Some(0.0), "light-clamped"),
        (spot(0.0, 3.0), Some(0.0), "light-clamped"),
        (spot(0.0, 0.0), None, "light-left-out"),
        (json!({"type": "laser"}), None, "light-left-out"),
        (
            json!({"type": "point", "intensity": -1}),
            None,
            "light-left-out",
        ),
        (
            json!({"type": "point", "color": [-1, 0, 0]}),
            None,
            "light-left-out",
        ),
    ] {
        let mut doc = lights_and_cameras();
        doc.json["extensions"]["KHR_lights_punctual"]["lights"][0] = light.clone();
        let world = doc.world();
        assert!(warnings(&world).contains(&name), "{light}");
        let inner = world.lights.iter().find_map(|light| match light.desc.kind {
            LightKind::Spot {
                inner_deg,
                outer_deg,
                ..
            } => {
                assert!(inner_deg < outer_deg && outer_deg <= 89.9);
                Some(inner_deg)
            }
            _ => None,
        });
        assert_eq!(inner, inner_deg, "{light}");
        assert_eq!(
            world.lights.len(),
            1 + usize::from(inner.is_some()),
            "{light}"
        );
    }
    let mut doc = lights_and_cameras();
    doc.json["extensions"]["KHR_lights_punctual"]["lights"][0]["range"] = (-1).into();
    let world = doc.world();
    assert_eq!(
        (world.lights[0].range_m, &warnings(&world)[..]),
        (None, &["light-clamped"][..])
    );
}

#[test]
fn lights_and_cameras_of_files_are_placed() {
    let folder = Folder::new();
    folder.write("m.glb", lights_and_cameras().glb());
    let mut desc = scene(&folder.0, "m.glb");
    desc.instances = vec![InstanceDesc {
        placement: trs(Vec3::X),
        ..instance("m")
    }];
    let world = load_scene(&desc).expect("loads");
    assert_eq!(world.lights.len(), 2);
    let lamp = &world.lights[0];
    assert_eq!((lamp.name.as_str(), lamp.range_m), ("m/lamp", Some(7.0)));
    assert_eq!(lamp.desc.color, Vec3::new(1.0, 0.5, 0.25));
    let LightKind::Spot {
        position,
        direction,
        intensity_cd,
        inner_deg,
        outer_deg,
        ..
    } = lamp.desc.kind
    else {
        panic!("{lamp:?}")
    };
    assert_eq!((position, intensity_cd), (Vec3::new(1.0, 4.0, 0.0), 40.0));
    assert!((direction - Vec3::NEG_Y).length() < 1e-5, "{direction}");
    assert!((inner_deg - 5.729578).abs() < 1e-3 && (outer_deg - 28.64789).abs() < 1e-3);
    assert!(matches!(
        world.lights[1].desc.kind,
        LightKind::Directional {
            intensity_lux: 1.0,
            ..
        }
    ));

    assert_eq!(
        world.cameras.len(),
        3,
        "with the default one: both look along the triangle"
    );
    let camera = &world.cameras[0];
    assert_eq!(camera.name, "m/eye");
    assert_eq!(camera.value.eye, Vec3::new(1.0, 4.0, 0.0));
    assert!((camera.value.target - Vec3::new(1.0, 3.0, 0.0)).length() < 1e-5);
    assert!((camera.value.up - Vec3::NEG_Z).length() < 1e-5);
    assert!((camera.value.fov_deg - 57.29578).abs() < 1e-3);
    assert_eq!(camera.value.orthographic_height_m, None);
    let flat = &world.cameras[1].value;
    assert_eq!((flat.eye, flat.orthographic_height_m), (Vec3::X, Some(3.0)));
    assert!(flat.near_m.is_some_and(|m| m > 0.0 && m < 1e-4), "{flat:?}");
    assert_eq!(warnings(&world), [""; 0]);

    desc.models[0].value.lights = false;
    assert!(load_scene(&desc).expect("loads").lights.is_empty());
    desc.models[0].value.lights = true;
    desc.instances[0].repeat = Some(RepeatDesc {
        count: [33, 1, 1],
        step: Vec3::X,
    });
    // More than 64 lights: lights with a place are lamps, of which the light tree chooses.
    let world = load_scene(&desc).expect("loads");
    assert_eq!((world.lights.len(), world.lamps.len()), (33, 33));
    let placed = world.all_lights().map(|l| l.desc.kind.position().is_some());
    assert!(placed.eq((0..66).map(|number| number % 2 == 0)));
    desc.instances[0].repeat = Some(RepeatDesc {
        count: [65, 1, 1],
        step: Vec3::X,
    });
    let (name, message) = one_error(load_scene(&desc));
    assert_eq!(name, "lights-too-many");
    assert!(
        message.starts_with("65 lights are directional"),
        "{message}"
    );
    desc.instances[0].repeat = Some(RepeatDesc {
        count: [725, 725, 1],
        step: Vec3::X,
    });
    desc.models[0].at.range = 7..9;
    let errors = load_scene(&desc).expect_err("they are too many");
    let error = (errors[0].name, errors[0].span.range.clone());
    assert_eq!(error, ("lights-too-many", 7..9));
    let limit = "1051250 lights including those of files, at most 1048576 are allowed";
    assert_eq!(errors[0].message, limit);
}

#[test]
fn cameras_without_a_view_are_errors() {
    let folder = Folder::new();
    for camera in [
        json!({"type": "orthographic"}),
        json!({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 0, "zfar": 1, "znear": 0}}),
        json!({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1e39, "zfar": 1, "znear": 0}}),
        json!({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 1, "znear": -1}}),
        json!({"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}),
    ] {
        let mut doc = Doc::triangle();
        doc.json["cameras"] = json!([camera]);
        doc.root_node(json!({"camera": 0}));
        folder.write("m.glb", doc.glb());
        let (name, message) = one_error(load_scene(&scene(&folder.0, "m.glb")));
        assert_eq!(name, "gltf-camera", "{camera}: {message}");
    }
}

#[test]
fn shapes_take_named_materials_and_grids() {
    let polished = MaterialDesc {
        roughness: Some(0.0),
        ..MaterialDesc::default()
    };
    let desc = SceneDesc {
        materials: vec![
            entry("polished", polished),
            entry("plain", MaterialDesc::default()),
        ],
        models: vec![
            entry(
                "floor",
                shape(ShapeDesc::Plane { size: [4.0, 4.0] }, Some("polished")),
            ),
            entry("block", shape(cube(), None)),
        ],
        instances: vec![InstanceDesc {
            name: Some("row".into()),
            placement: trs(Vec3::Y),
            repeat: Some(RepeatDesc {
                count: [2, 1, 3],
                step: Vec3::new(2.0, 0.0, 5.0),
            }),
            material: Some(InstanceMaterialDesc::Named(unplaced("plain"))),
            ..instance("block")
        }],
        ..SceneDesc::default()
    };
    let world = load_scene(&desc).expect("loads");
    assert_eq!((world.meshes.len(), world.instances.len()), (2, 7));
    let last = &world.instances[5];
    assert_eq!(last.name, "row[1,0,2]");
    assert_eq!(
        last.world_from_object,
        Affine3A::from_translation(Vec3::new(2.0, 1.0, 10.0))
    );
    assert_eq!(world.materials[last.material].name, "plain");
    let floor = &world.instances[6];
    assert_eq!(
        floor.name, "floor",
        "a model that no instance names stands at the origin"
    );
    let material = &world.materials[floor.material];
    assert_eq!(
        (
            material.name.as_str(),
            material.roughness,
            material.double_sided
        ),
        ("polished", 0.0, true)
    );
}

#[test]
fn dangling_names_are_all_reported() {
    let mut desc = SceneDesc {
        models: vec![entry("ball", shape(cube(), None))],
        instances: vec![instance("bal"), instance("x")],
        ..SceneDesc::default()
    };
    let errors = load_scene(&desc).expect_err("no such model");
    assert_eq!(
        errors.iter().map(|e| e.name).collect::<Vec<_>>(),
        ["unknown-name"; 2]
    );
    assert_eq!(errors[0].help.as_deref(), Some("did you mean \"ball\"?"));
    desc.instances.clear();
    desc.models[0].value.material = Some(unplaced("gold"));
    assert_eq!(one_error(load_scene(&desc)).0, "unknown-name");
}

#[test]
fn files_are_searched_beside_the_scene_then_in_assets() {
    let (own, assets) = (Folder::new(), Folder::new());
    assets.write("sub/m.glb", Doc::triangle().glb());
    let desc = scene(&own.0, "sub/m.glb");
    let (name, message) = one_error(load_scene(&desc));
    assert_eq!(name, "file-not-found");
    assert!(
        message.contains(own.0.to_str().expect("UTF-8")),
        "{message}"
    );
    let options = LoadOptions {
        assets: vec![assets.0.clone()],
        ..LoadOptions::default()
    };
    let world = load(&desc, &options).expect("found in assets");
    assert!(world.files[0].ends_with("sub/m.glb"));
}

#[test]
fn one_file_is_read_once() {
    let folder = Folder::new();
    folder.write("m.glb", stone().glb());
    let mut desc = scene(&folder.0, "m.glb");
    desc.models.push(desc.models[0].clone());
    desc.models[1].name = "again".into();
    let world = load_scene(&desc).expect("loads");
    assert_eq!(
        (world.meshes.len(), world.instances.len(), world.files.len()),
        (1, 2, 1)
    );
    assert_eq!((world.materials.len(), world.textures.len()), (1, 2));
}

/// Buffers and images in files beside the glTF, with percent-coded names.
#[test]
fn separate_files_are_found() {
    let folder = Folder::new();
    let mut doc = stone();
    folder.write("data/my buffer.bin", &doc.bin);
    folder.write("data/ü.png", png(1, 1, [9, 8, 7, 6]));
    doc.json["buffers"][0]["uri"] = "data/my%20buffer.bin".into();
    doc.json["images"] = json!([{"uri": "data/%C3%BC.png"}]);
    folder.write("m.gltf", serde_json::to_vec(&doc.json).expect("JSON"));
    let world: World = load_scene(&scene(&folder.0, "m.gltf")).expect("loads");
    assert_eq!(world.textures[0].rgba, [9, 8, 7, 6]);
    assert_eq!(world.files.len(), 3);
}

#[test]
fn data_uris_are_read_in_base64_percent_encoded_and_in_percent_encoded_base64() {
    let mut doc = Doc::triangle();
    let bytes = std::mem::take(&mut doc.bin);
    let text = data_encoding::BASE64.encode(&bytes);
    let percent: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    for uri in [
        format!("application/octet-stream;base64,{text}"),
        format!(";base64,{}", text.replace('A', "%41")),
        format!(",{percent}"),
    ] {
        doc.json["buffers"][0]["uri"] = format!("data:{uri}").into();
        let positions = &doc.world().meshes[0].positions;
        assert_eq!(positions[..], [Vec3::ZERO, Vec3::X, Vec3::Y], "{uri}");
    }
}

/// A model that names a texture, in a folder.
fn with_texture(folder: &Folder, uri: &str) -> reflet::scene::diagnostic::Diagnostic {
    let mut doc = textured(&png(1, 1, [0; 4]));
    doc.json["images"][0] = json!({"uri": uri});
    folder.write("m.glb", doc.glb());
    let errors = load_scene(&scene(&folder.0, "m.glb")).expect_err("no texture");
    errors.into_iter().next().expect("an error")
}

#[test]
fn files_that_stand_in_for_others_are_named() {
    let folder = Folder::new();
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12\n";
    folder.write("wood.png", pointer);
    let error = with_texture(&folder, "wood.png");
    assert_eq!(error.name, "git-lfs-pointer");
    assert!(error.help.is_some_and(|help| help.contains("git lfs pull")));
    folder.write("wood.png", b"<!DOCTYPE html><title>wood.png</title>");
    assert_eq!(with_texture(&folder, "wood.png").name, "web-page");
    for model in ["p.gltf", "p.glb"] {
        folder.write(model, pointer);
        let errors = load_scene(&scene(&folder.0, model)).expect_err("no model");
        assert_eq!(errors[0].name, "git-lfs-pointer", "{model}");
    }
}

#[test]
fn files_there_under_another_case_or_unicode_form_are_named() {
    let folder = Folder::new();
    folder.write("Wood.PNG", png(1, 1, [1; 4]));
    let error = with_texture(&folder, "wood.png");
    assert_eq!(error.name, "file-not-found");
    assert_eq!(error.help.as_deref(), Some("it is there as \"Wood.PNG\""));
    folder.write("cafe\u{301}.png", png(1, 1, [1; 4]));
    let help = with_texture(&folder, "caf\u{e9}.png").help;
    assert_eq!(help.as_deref(), Some("it is there as \"cafe\u{301}.png\""));
    let errors = load_scene(&scene(&folder.0, "M.glb")).expect_err("another name");
    assert_eq!(errors[0].help.as_deref(), Some("it is there as \"m.glb\""));
    let mut doc = Doc::triangle();
    doc.json["buffers"][0]["uri"] = "lost.bin".into();
    folder.write("m.gltf", doc.json.to_string());
    let errors = load_scene(&scene(&folder.0, "m.gltf")).expect_err("no buffer");
    let wanted = "copy it there: models are handed on with the files that they name";
    assert_eq!(errors[0].help.as_deref(), Some(wanted));
}
