//! KHR_materials_variants: materials chosen by the variant's name.

use crate::kit::*;

/// A triangle with a plain material, and two other materials in three variants.
fn shoe() -> Doc {
    let mut doc = Doc::triangle();
    for name in ["plain", "red", "blue"] {
        doc.material(json!({"name": name}));
    }
    doc.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    let names = ["beach", "street", "night"].map(|name| json!({"name": name}));
    doc.json["extensions"] = json!({"KHR_materials_variants": {"variants": names}});
    doc.primitive("material", 0.into());
    let mappings = json!([
        {"material": 1, "variants": [0, 2]},
        {"material": 2, "variants": [1]}
    ]);
    doc.primitive(
        "extensions",
        json!({"KHR_materials_variants": {"mappings": mappings}}),
    );
    // A second primitive, which no variant changes.
    let other = json!({"attributes": {"POSITION": 0}});
    let primitives = doc.json["meshes"][0]["primitives"].as_array_mut();
    primitives.expect("primitives").push(other);
    doc
}

#[test]
fn a_variant_is_chosen_by_name() {
    let folder = Folder::new();
    folder.write("m.glb", shoe().glb());
    let mut desc = scene(&folder.0, "m.glb");
    for (variant, expected) in [
        (None, "plain"),
        (Some("beach"), "red"),
        (Some("street"), "blue"),
        (Some("night"), "red"),
    ] {
        desc.models[0].value.variant = variant.map(unplaced);
        let world = load_scene(&desc).expect("loads");
        let names: Vec<_> = world
            .instances
            .iter()
            .map(|i| world.materials[i.material].name.as_str())
            .collect();
        assert_eq!(names, [expected, "default"], "{variant:?}");
        let [listed] = &world.models[..] else {
            panic!("one file is read: {:?}", world.models);
        };
        assert_eq!(listed.variants, ["beach", "street", "night"]);
        assert_eq!(listed.shown.as_deref(), variant);
    }
    desc.models[0].value.variant = Some(unplaced("nigt"));
    let errors = load_scene(&desc).expect_err("no such variant");
    assert_eq!(errors[0].name, "unknown-variant");
    let help = errors[0].help.as_deref().expect("help");
    assert!(help.contains("did you mean \"night\"?"), "{help}");
    assert!(help.contains("beach, street, night"), "{help}");
}

#[test]
fn mappings_to_nothing_are_errors() {
    for (key, value) in [("material", json!(9)), ("variants", json!([3]))] {
        let mut doc = shoe();
        let primitive = &mut doc.json["meshes"][0]["primitives"][0];
        primitive["extensions"]["KHR_materials_variants"]["mappings"][0][key] = value;
        let (name, message) = one_error(doc.load());
        assert_eq!(name, "gltf-index", "{message}");
    }
}
