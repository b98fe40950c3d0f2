//! Materials of glTF files and their overrides in scene text.

use std::f32::consts::FRAC_PI_2;

use glam::Vec4;
use reflet::{
    scene::desc::{InstanceMaterialDesc, MaterialDesc, ReflectionMode},
    world::Wrap,
};

use crate::kit::*;

#[test]
fn materials_arrive_whole() {
    let mut doc = stone();
    doc.json["materials"][0]["extensions"] = json!({
        "KHR_materials_emissive_strength": {"emissiveStrength": 8},
        "KHR_materials_ior": {"ior": 2},
        "KHR_materials_specular": {"specularFactor": 0.5}
    });
    let world = doc.world();
    let m = &world.materials[0];
    assert_eq!(
        (m.name.as_str(), m.alpha_cutoff, m.double_sided),
        ("stone", Some(0.5), true)
    );
    assert_eq!(m.base_color, Vec4::new(0.1, 0.2, 0.3, 0.4));
    assert_eq!((m.metallic, m.roughness), (0.25, 0.75));
    assert_eq!(m.emission, Vec3::new(8.0, 4.0, 0.0));
    assert!(
        (m.reflectivity - 1.0 / 9.0).abs() < 1e-6,
        "((2 − 1)/(2 + 1))²: {}",
        m.reflectivity
    );
    assert_eq!((m.specular, m.specular_color), (Some(0.5), None));
    let color = m.base_color_texture.expect("texture");
    assert_eq!(
        (color.wrap, color.nearest, color.uv_set),
        ([Wrap::Clamp, Wrap::Mirror], true, 0)
    );
    assert_eq!(color.transform, [Vec3::X, Vec3::Y]);
    // An image used as color and as data is stored twice.
    let data = m.metallic_roughness_texture.expect("texture");
    assert_ne!(color.texture, data.texture);
    assert!(world.textures[color.texture].srgb && !world.textures[data.texture].srgb);
    for texture in &world.textures {
        assert_eq!((texture.width, texture.height), (3, 2));
        assert_eq!(texture.rgba, [10, 20, 30, 40].repeat(6));
    }
}

#[test]
fn texture_transform_turns_like_the_viewers() {
    let mut doc = stone();
    doc.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = json!({
        "KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": FRAC_PI_2, "scale": [2, 3], "texCoord": 0}
    });
    let world = doc.world();
    let rows = world.materials[0]
        .base_color_texture
        .expect("texture")
        .transform;
    // Texture transform: u' = c·sx·u + s·sy·v + ox, v' = −s·sx·u + c·sy·v + oy
    assert!(
        (rows[0] - Vec3::new(0.0, 3.0, 0.5)).length() < 1e-5,
        "{rows:?}"
    );
    assert!(
        (rows[1] - Vec3::new(-2.0, 0.0, 0.25)).length() < 1e-5,
        "{rows:?}"
    );
}

#[test]
fn unsupported_features_are_warned_about() {
    let mut doc = stone();
    doc.json["extensionsUsed"] = json!([
        "KHR_materials_sss",
        "KHR_materials_unlit",
        "VENDOR_look",
        "KHR_materials_sss"
    ]);
    let world = doc.world();
    assert_eq!(warnings(&world), ["extension-ignored", "extension-ignored"]);
    let messages = world.warnings.iter().map(|w| w.message.as_str());
    assert_eq!(
        messages.take(2).collect::<Vec<_>>(),
        [
            "extension \"KHR_materials_sss\" is ignored",
            "extension \"VENDOR_look\" is ignored"
        ]
    );
    let mut doc = stone();
    doc.json["materials"][0]["extensions"] = json!({"KHR_materials_unlit": {}});
    let world = doc.world();
    assert!(warnings(&world).is_empty());
    let m = &world.materials[0];
    assert!(m.unlit && m.base_color_texture.is_some());
    assert_eq!(m.base_color, Vec4::new(0.1, 0.2, 0.3, 0.4));
    assert_eq!((m.emission, m.reflectivity), (Vec3::ZERO, 0.0));
    assert_eq!((m.metallic, m.alpha_cutoff), (0.0, Some(0.5)));
    assert_eq!(m.reflection, ReflectionMode::None);
}

#[test]
fn blended_materials_are_opaque_where_nothing_is_clear() {
    for (alpha, has_texture, blended) in
        [(0.4, false, true), (1.0, true, true), (1.0, false, false)]
    {
        let mut doc = stone();
        let material = &mut doc.json["materials"][0];
        material["alphaMode"] = "BLEND".into();
        material["pbrMetallicRoughness"] = json!({"baseColorFactor": [1, 1, 1, alpha]});
        if has_texture {
            // A texture with alpha 40 / 255.
            material["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
        }
        let world = doc.world();
        assert!(warnings(&world).is_empty());
        assert_eq!(world.materials[0].alpha_cutoff, None);
        assert_eq!(world.materials[0].blended, blended, "alpha {alpha}");
    }
}

/// Tangents point along u of the coordinates that the map is sampled with.
#[test]
fn generated_tangents_follow_the_texture_transform() {
    let corners = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
    for (transform, tangent, sign) in [
        (json!({}), Vec3::X, -1.0),
        (
            json!({"scale": [3, 0.5], "offset": [0.2, 0.7]}),
            Vec3::X,
            -1.0,
        ),
        (json!({"scale": [-1, 1]}), Vec3::NEG_X, 1.0),
        (json!({"rotation": FRAC_PI_2}), Vec3::Y, -1.0),
        (json!({"rotation": -FRAC_PI_2}), Vec3::NEG_Y, -1.0),
    ] {
        let mut doc = Doc::triangle();
        let normals = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
        let uv = doc.floats("VEC2", &corners);
        doc.attribute("NORMAL", normals);
        doc.attribute("TEXCOORD_0", uv);
        let texture = doc.texture(&png(1, 1, [128, 128, 255, 255]));
        let map = json!({"index": texture, "extensions": {"KHR_texture_transform": transform}});
        doc.material(json!({"normalTexture": map}));
        doc.primitive("material", 0.into());
        let world = doc.world();
        // u' = u cos + v sin: a map turned by 90° has its u along v.
        for found in &world.meshes[0].tangents {
            let turned = found.truncate().distance(tangent);
            assert!(turned < 1e-5, "{transform}: {found}");
            assert_eq!(found.w, sign, "{transform}");
        }
    }
}

#[test]
fn overrides_apply_star_first_then_name_then_instance() {
    let folder = Folder::new();
    folder.write("m.glb", stone().glb());
    let mut desc = scene(&folder.0, "m.glb");
    let star = MaterialDesc {
        roughness: Some(0.5),
        metallic: Some(0.5),
        occlusion_strength: Some(0.25),
        uv_scale: Some([2.0, 2.0]),
        ..MaterialDesc::default()
    };
    let named = MaterialDesc {
        roughness: Some(0.1),
        uv_scale: Some([3.0, 4.0]),
        emission_strength: Some(2.0),
        reflection: Some(ReflectionMode::Mirror),
        ..MaterialDesc::default()
    };
    // The entry with a name is first in the text, "*" still applies first.
    desc.models[0].value.overrides = vec![entry("stone", named), entry("*", star)];
    let over = MaterialDesc {
        base_color: Some(Vec3::ONE),
        ..MaterialDesc::default()
    };
    desc.instances = vec![
        instance("m"),
        InstanceDesc {
            material: Some(InstanceMaterialDesc::Override(Box::new(over))),
            dynamic: true,
            ..instance("m")
        },
    ];
    let world = load_scene(&desc).expect("loads");
    assert_eq!(
        (
            world.meshes.len(),
            world.materials.len(),
            world.textures.len()
        ),
        (1, 2, 2)
    );
    let [plain, white] = [0, 1].map(|i| &world.materials[world.instances[i].material]);
    assert_eq!((plain.roughness, plain.metallic), (0.1, 0.5));
    assert_eq!(plain.occlusion_strength, 0.25);
    assert_eq!(plain.reflection, ReflectionMode::Mirror);
    assert_eq!(plain.emission, Vec3::new(2.0, 1.0, 0.0));
    let rows = plain.slots()[0].expect("texture").transform;
    assert_eq!(rows, [Vec3::X * 3.0, Vec3::Y * 4.0]);
    assert_eq!(
        (white.base_color, white.roughness),
        (Vec4::new(1.0, 1.0, 1.0, 0.4), 0.1)
    );
    assert_eq!([0, 1].map(|i| world.instances[i].dynamic), [false, true]);

    desc.models[0].value.overrides = vec![entry("stome", MaterialDesc::default())];
    let errors = load_scene(&desc).expect_err("no such material");
    assert_eq!(errors[0].name, "unknown-material");
    assert_eq!(errors[0].help.as_deref(), Some("did you mean \"stone\"?"));
}

#[test]
fn an_overridden_image_is_never_decoded() {
    let mut doc = Doc::triangle();
    let texture = doc.texture(b"not an image");
    let pbr = json!({"baseColorTexture": {"index": texture}});
    doc.material(json!({"name": "stone", "pbrMetallicRoughness": pbr}));
    doc.primitive("material", 0.into());
    assert_eq!(doc.error().0, "image-unsupported");
    let (folder, mut desc) = doc.scene();
    folder.write("own.png", png(1, 1, [1, 2, 3, 4]));
    let own = MaterialDesc {
        base_color_texture: Some(unplaced("own.png")),
        ..MaterialDesc::default()
    };
    desc.models[0].value.overrides = vec![entry("stone", own)];
    let world = load_scene(&desc).expect("loads");
    assert_eq!(world.textures.len(), 1);
    assert_eq!(world.textures[0].rgba, [1, 2, 3, 4]);
    assert_eq!(world.files.len(), 2);
}
