//! Light of images that a file brings (EXT_lights_image_based).

use glam::DVec3;
use reflet::{math::linear_from_srgb, world::environment::Panorama};

use crate::kit::*;

/// Colors of the faces +X, -X, +Y, -Y, +Z, -Z: their red tells them apart, their green is whole.
fn shade(face: usize) -> u8 {
    40 * face as u8 + 20
}

/// Directions to the middles of the faces.
const MIDDLES: [Vec3; 6] = [
    Vec3::X,
    Vec3::NEG_X,
    Vec3::Y,
    Vec3::NEG_Y,
    Vec3::Z,
    Vec3::NEG_Z,
];

/// The triangle below a cube map of plain faces with this alpha; `light` has its further keys.
fn lit(alpha: u8, light: Value) -> Doc {
    let mut doc = Doc::triangle();
    let faces: Vec<usize> = (0..6)
        .map(|face| {
            let view = doc.view(&png(4, 4, [shade(face), 255, 0, alpha]));
            doc.image(json!({"bufferView": view, "mimeType": "image/png"}))
        })
        .collect();
    let mut whole = json!({"specularImages": [faces], "specularImageSize": 4});
    let more = light.as_object().expect("keys").clone();
    whole.as_object_mut().expect("keys").extend(more);
    doc.json["extensions"] = json!({"EXT_lights_image_based": {"lights": [whole]}});
    doc.json["scenes"][0]["extensions"] = json!({"EXT_lights_image_based": {"light": 0}});
    doc.json["extensionsRequired"] = json!(["EXT_lights_image_based"]);
    doc
}

/// Radiance of the texel in a direction, by the layout of OpenEXR's "Environment Maps".
fn radiance(panorama: &Panorama, direction: Vec3) -> Vec3 {
    let direction = direction.normalize();
    let longitude = direction.x.atan2(direction.z) / std::f32::consts::TAU;
    let colatitude = direction.y.acos() / std::f32::consts::PI;
    let x = ((0.5 - longitude) * panorama.width as f32) as u32 % panorama.width;
    let y = ((colatitude * panorama.height as f32) as u32).min(panorama.height - 1);
    let texel = panorama.texels[(y * panorama.width + x) as usize];
    // Normal half floats, by IEEE 754.
    let [r, g, b, _] = texel.map(|bits| {
        let significand = 1.0 + f32::from(bits & 0x3ff) / 1024.0;
        let exponent = i32::from(bits >> 10) - 15;
        match bits {
            0 => 0.0,
            _ => significand * 2.0_f32.powi(exponent) * panorama.scale,
        }
    });
    Vec3::new(r, g, b)
}

fn panorama(world: &World) -> &Panorama {
    let panorama = world.environment.panorama.as_deref();
    panorama.expect("the light of the file")
}

/// Radiance of a byte, by IEC 61966-2-1.
fn linear(byte: u8) -> f32 {
    linear_from_srgb(f32::from(byte) / 255.0)
}

#[test]
fn a_cube_map_becomes_the_environment_turned_and_scaled() {
    for rotation in [
        Quat::IDENTITY,
        Quat::from_rotation_y(1.0),
        Quat::from_rotation_x(-0.7),
    ] {
        let light = json!({"rotation": rotation.to_array(), "intensity": 3.0});
        let world = lit(128, light).world();
        assert_eq!(warnings(&world), [""; 0]);
        assert!(world.environment.casts_rays());
        for (face, middle) in MIDDLES.into_iter().enumerate() {
            let found = radiance(panorama(&world), rotation * middle);
            let factor = 3.0 * 255.0 / 128.0;
            let wanted = Vec3::new(linear(shade(face)), 1.0, 0.0) * factor;
            assert!(
                found.abs_diff_eq(wanted, 2e-3 * factor),
                "{rotation} {face}: {found} {wanted}"
            );
        }
    }
    // A cube of one color is a sphere of it.
    let world = lit(255, json!({"specularImages": [[5, 5, 5, 5, 5, 5]]})).world();
    let mean = panorama(&world).mean();
    let wanted = DVec3::new(linear(shade(5)).into(), 1.0, 0.0);
    assert!(mean.abs_diff_eq(wanted, 1e-3), "{mean}");
}

/// The converter of USD stores all dome lights of a stage as one panorama.
#[test]
fn domes_of_a_stage_are_the_environment() {
    // Two pixels of Radiance HDR: 1, 0.5, 0.25 on the left, twice as bright on the right.
    let head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    let sky = [&head[..], &[128, 64, 32, 129, 128, 64, 32, 130]].concat();
    let domes = |bytes: &[u8]| {
        let mut doc = Doc::triangle();
        let view = doc.view(bytes);
        doc.json["scenes"][0]["extras"] = json!({"usd": {"environment": view}});
        doc
    };
    let world = domes(&sky).world();
    for (direction, wanted) in [(Vec3::X, 1.0), (Vec3::NEG_X, 2.0)] {
        let found = radiance(panorama(&world), direction);
        let wanted = Vec3::new(1.0, 0.5, 0.25) * wanted;
        assert!(found.abs_diff_eq(wanted, 2e-2), "{direction}: {found}");
    }
    assert_eq!(domes(&sky[..50]).error().0, "image-broken");
}

/// Loads the file in a scene that `change` changes.
fn in_scene(doc: &Doc, change: impl FnOnce(&mut SceneDesc)) -> World {
    let (_folder, mut desc) = doc.scene();
    change(&mut desc);
    load_scene(&desc).expect("valid")
}

#[test]
fn the_environment_of_the_scene_wins() {
    let doc = lit(255, json!({}));
    let has_light = |world: &World| world.environment.panorama.is_some();
    assert!(has_light(&in_scene(&doc, |_| {})));
    assert!(!has_light(&in_scene(&doc, |desc| {
        desc.environment.is_written = true;
    })));
    assert!(!has_light(&in_scene(&doc, |desc| {
        desc.models[0].value.lights = false;
    })));
    let mut other = doc;
    other.json["scenes"][0]
        .as_object_mut()
        .expect("a scene")
        .remove("extensions");
    assert!(!has_light(&other.world()), "no scene has the light");
}

#[test]
fn broken_lights_of_images_are_refused() {
    for (light, part) in [
        (json!({"intensity": -1.0}), "intensity"),
        (json!({"rotation": [0, 0, 0, 0]}), "rotation"),
        (json!({"specularImages": [[0, 1, 2]]}), "six faces"),
        (json!({"specularImages": []}), "six faces"),
        (
            json!({"specularImages": [[0, 1, 2, 3, 4, 6]]}),
            "image 6 does not exist",
        ),
        (json!({"intensity": 3e38}), "not finite"),
    ] {
        let (_, message) = lit(1, light.clone()).error();
        assert!(message.contains(part), "{light}: {message}");
    }
    let mut doc = lit(255, json!({}));
    doc.json["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 1.into();
    assert_eq!(doc.error().0, "gltf-light");
}
