//! Material layers of glTF extensions: transmission, coats and the like.

use crate::kit::*;

#[test]
fn what_passes_through_and_what_lies_over_a_material_is_read() {
    let mut doc = stone();
    doc.json["materials"][0]["doubleSided"] = false.into();
    doc.json["materials"][0]["extensions"] = json!({
        "KHR_materials_transmission": {"transmissionFactor": 0.75},
        "KHR_materials_ior": {"ior": 2},
        "KHR_materials_volume": {
            "thicknessFactor": 0.1, "attenuationDistance": 0.5, "attenuationColor": [0.5, 1, 1]
        },
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25}
    });
    let world = doc.world();
    assert!(warnings(&world).is_empty(), "{:?}", world.warnings);
    let m = &world.materials[0];
    assert_eq!((m.transmission, m.ior, m.solid), (Some(0.75), 2.0, true));
    assert!((m.reflectivity - 1.0 / 9.0).abs() < 1e-6);
    assert!(m.double_sided, "rays leave it through its back");
    let extinction = m.extinction();
    assert!((extinction.x - 2.0 * 2.0_f32.ln()).abs() < 1e-5 && extinction.y == 0.0);
    assert_eq!((m.clearcoat, m.clearcoat_roughness), (Some(0.5), 0.25));

    let mut doc = stone();
    doc.json["materials"][0]["extensions"] = json!({
        "KHR_materials_transmission": {"transmissionTexture": {"index": 0}},
        "KHR_materials_clearcoat": {"clearcoatNormalTexture": {"index": 0}},
        "KHR_materials_volume": {"attenuationDistance": 0}
    });
    let error = &doc.load().expect_err("a distance of 0")[0];
    let said = "attenuationDistance must be above 0";
    assert!(error.message.contains(said), "{}", error.message);
    doc.json["materials"][0]["extensions"]["KHR_materials_iridescence"] =
        json!({"iridescenceIor": 1e39});
    doc.json["materials"][0]["extensions"]["KHR_materials_volume"] = json!({});
    let said = "iridescenceIor is inf, expected at least 1";
    let errors = doc.load().expect_err("no number of this type");
    assert!(errors[0].message.contains(said), "{}", errors[0].message);
    doc.json["materials"][0]["extensions"]["KHR_materials_iridescence"] = json!({});
    let world = doc.world();
    assert!(warnings(&world).is_empty(), "{:?}", world.warnings);
    assert_eq!(
        (
            world.materials[0].transmission,
            world.materials[0].clearcoat
        ),
        (None, None)
    );
}

#[test]
fn specular_sheen_and_the_textures_of_layers_are_read() {
    let mut doc = stone();
    let map = json!({"index": 0, "texCoord": 1});
    let all = serde_json::from_str(include_str!("layers/all.json")).expect("JSON");
    doc.json["materials"][0]["extensions"] = all;
    let world = doc.world();
    let m = &world.materials[0];
    assert_eq!(m.clearcoat_normal_scale, 0.5);
    assert!(m.has_coat_normals() && !world.meshes[0].tangents.is_empty());
    assert_eq!((m.specular, m.edge_tint), (Some(0.75), true));
    assert_eq!(m.specular_color, Some(Vec3::new(2.0, 1.0, 0.0)));
    assert_eq!(m.sheen_color, Some(Vec3::new(0.5, 0.25, 1.0)));
    assert_eq!(m.sheen_roughness, 0.3);
    assert!((m.reflectivity - 0.04).abs() < 1e-6);
    let kinds = m.layer_textures.map(|used| {
        let texture = used.expect("read").texture;
        if world.textures[texture].srgb {
            'c'
        } else {
            '-'
        }
    });
    assert_eq!(String::from_iter(kinds), "-cc---c------");
    assert_eq!((m.iridescence, m.iridescence_ior), (Some(0.5), 1.75));
    let film_nm = (m.iridescence_least_nm, m.iridescence_thickness_nm);
    assert_eq!(film_nm, (50.0, 650.0));
    assert_eq!((m.anisotropy, m.dispersion), (Some(0.25), Some(2.0)));
    let drafts = (m.clearcoat_ior, m.diffuse_roughness);
    assert_eq!(drafts, (Some(2.0), Some(0.75)));
    let passed = (m.diffuse_transmission, m.diffuse_transmission_color);
    assert_eq!(passed, (Some(0.625), Vec3::new(0.25, 0.5, 1.0)));
    let scattered = (m.scattering_color, m.scattering_anisotropy, m.solid);
    assert_eq!(scattered, (Some(Vec3::new(0.5, 0.25, 1.0)), 0.25, true));
    // Where a quarter of white light is scattered straight on, three quarters count as scattered.
    assert_eq!(m.single_scattering_albedo().z, 1.0);
    assert!((m.extinction().z / (0.5 * 2.0_f32.ln()) - 0.75).abs() < 1e-5);
    assert!((m.anisotropy_rotation_deg - 0.5_f32.to_degrees()).abs() < 1e-4);
    // An extension that stands within a foreign extension is ignored.
    let layers = &mut doc.json["materials"][0]["extensions"];
    let edges = layers["KHR_materials_specular"]["extensions"].take();
    layers["KHR_materials_clearcoat"]["extensions"] = edges;
    let m = &doc.world().materials[0];
    assert_eq!((m.edge_tint, m.clearcoat_ior), (false, None));
    // Textures of layers with a factor of 0 are not loaded.
    doc.json["materials"][0]["extensions"] = json!({
        "KHR_materials_specular": {"specularFactor": 0, "specularTexture": map},
        "KHR_materials_sheen": {"sheenColorTexture": map},
        "KHR_materials_clearcoat": {"clearcoatTexture": map, "clearcoatNormalTexture": map}
    });
    let world = doc.world();
    let m = &world.materials[0];
    assert_eq!(
        (m.reflectivity, m.sheen_color, m.clearcoat),
        (0.0, None, None)
    );
    assert!(m.layer_textures.iter().all(Option::is_none));
    doc.json["materials"][0]["extensions"] = json!({"KHR_materials_sheen": {
        "sheenColorFactor": [1, 1, 1], "sheenColorTexture": {"index": 99}
    }});
    let error = &doc.load().expect_err("no such texture")[0];
    let path = "/materials/0/extensions/KHR_materials_sheen/sheenColorTexture";
    let expected = format!("material 0 \"stone\": sheenColorTexture ({path}): texture 99 does not");
    assert!(error.message.starts_with(&expected), "{}", error.message);
}

#[test]
fn coats_follow_their_own_normal_map_or_none() {
    let mut doc = stone();
    let maps = |own: serde_json::Value, coat: serde_json::Value| {
        json!({"normalTexture": own, "extensions": {
            "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatNormalTexture": coat}
        }})
    };
    let map = json!({"index": 0});
    let turned = json!({"index": 0, "extensions": {"KHR_texture_transform": {"rotation": 1}}});
    let tiled = json!({"index": 0, "extensions": {"KHR_texture_transform": {"scale": [3, 2]}}});
    let weaker = json!({"index": 0, "scale": 0.5});
    let none = serde_json::Value::Null;
    let cases = [
        (none.clone(), none.clone(), false, ""),
        (map.clone(), map.clone(), false, ""),
        (map.clone(), none.clone(), true, ""),
        (none, map.clone(), true, ""),
        (map.clone(), weaker, true, ""),
        (map.clone(), tiled, true, ""),
        (map, turned, true, "tangents-shared"),
    ];
    for (own, coat, differs, warning) in cases {
        let material = doc.json["materials"][0].as_object_mut();
        let said = maps(own, coat);
        material
            .expect("an object")
            .extend(said.as_object().expect("an object").clone());
        let world = doc.world();
        assert_eq!(world.materials[0].has_coat_normals(), differs, "{said}");
        assert_eq!(warnings(&world).concat(), warning, "{said}");
    }
}

#[test]
fn layers_that_an_animation_moves_are_there_at_rest() {
    let mut doc = stone();
    doc.json["materials"][0]["extensions"] = json!({
        "KHR_materials_specular": {"specularFactor": 0},
        "KHR_materials_sheen": {"sheenColorFactor": [0, 0, 0]},
        "KHR_materials_clearcoat": {}
    });
    let times = doc.floats("SCALAR", &[0.0, 1.0]);
    let numbers = doc.floats("SCALAR", &[0.0, 1.0]);
    let colors = doc.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let channel = |sampler: u32, of: &str| {
        let pointer = format!("/materials/0/extensions/KHR_materials_{of}");
        json!({"sampler": sampler, "target": {"path": "pointer",
               "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}})
    };
    doc.json["animations"] = json!([{
        "samplers": [{"input": times, "output": numbers}, {"input": times, "output": colors}],
        "channels": [channel(0, "specular/specularFactor"), channel(1, "sheen/sheenColorFactor"),
                     channel(0, "clearcoat/clearcoatFactor")]
    }]);
    let world = doc.world();
    let m = &world.materials[0];
    assert_eq!((m.specular, m.specular_color), (Some(0.0), None));
    assert_eq!((m.sheen_color, m.clearcoat), (Some(Vec3::ZERO), Some(0.0)));
    assert!((m.reflectivity - 0.04).abs() < 1e-6);
}

#[test]
fn glass_keeps_its_index_without_a_reflection() {
    let mut doc = stone();
    doc.json["materials"][0]["extensions"] = json!({
        "KHR_materials_specular": {"specularFactor": 0},
        "KHR_materials_transmission": {"transmissionFactor": 1}
    });
    let world = doc.world();
    let m = &world.materials[0];
    assert_eq!(m.specular, Some(0.0));
    assert!((m.reflectivity - 0.04).abs() < 1e-6);
}
