//! Extensions that files require.

use reflet::world::gltf::supported_extensions;

use crate::kit::*;

#[test]
fn required_extensions_are_refused_by_name() {
    let mut doc = Doc::triangle();
    doc.json["extensionsRequired"] = json!(["KHR_texture_transform", "VENDOR_magic"]);
    for result in [doc.load(), doc.load_with(&LoadOptions::default())] {
        let errors = result.expect_err("unsupported");
        assert_eq!(errors[0].name, "extension-unsupported");
        let message = &errors[0].message;
        assert!(message.contains("VENDOR_magic") && !message.contains("texture_transform"));
        let help = errors[0].help.as_deref().expect("help");
        assert!(help.contains("KHR_lights_punctual") && !help.contains("--lenient"));
        assert!(errors[0].file.is_some());
    }
}

#[test]
fn a_required_look_is_refused_when_asked() {
    let mut doc = Doc::triangle();
    let names = ["KHR_materials_sss", "VENDOR_materials_glow"];
    doc.json["extensionsRequired"] = json!(names);
    let errors = doc.load().expect_err("unsupported");
    let help = errors[0].help.as_deref().expect("help");
    assert!(help.contains("--strict"), "{help}");
    let world = doc.load_with(&LoadOptions::default()).expect("loads");
    assert_eq!(warnings(&world), ["extension-left-out"; 2]);
    for (warning, name) in world.warnings.iter().zip(names) {
        assert!(warning.message.contains(name), "{}", warning.message);
    }
}

/// An image that is missing, two that no decoder reads, and one that is good.
#[test]
fn images_that_cannot_be_read_are_left_out_when_asked() {
    let mut doc = Doc::triangle();
    let good = doc.texture(&png(2, 2, [9, 9, 9, 255]));
    let gif = doc.texture(b"GIF89a\x01\0\x01\0\x80\0\0");
    let cut = doc.texture(&png(2, 2, [9, 9, 9, 255])[..20]);
    let image = doc.image(json!({"uri": "missing.png"}));
    let missing = doc.add("textures", json!({"source": image}));
    let slot = |texture: usize| json!({"index": texture});
    doc.material(
        json!({"name": "rock", "normalTexture": slot(missing), "emissiveTexture": slot(good),
        "occlusionTexture": slot(cut), "pbrMetallicRoughness": {"baseColorTexture": slot(gif)}}),
    );
    doc.primitive("material", 0.into());
    let errors = doc.load().expect_err("images are missing");
    assert!(
        errors.iter().any(|e| e.name == "file-not-found"),
        "{errors:?}"
    );
    let world = doc.load_with(&LoadOptions::default()).expect("valid");
    let material = &world.materials[world.instances[0].material];
    assert_eq!(material.emission_texture.map(|used| used.texture), Some(0));
    assert_eq!(
        (
            material.slots().iter().flatten().count(),
            world.textures.len()
        ),
        (1, 1)
    );
    assert_eq!(warnings(&world), ["image-left-out"; 3]);
    for (warning, slot) in world
        .warnings
        .iter()
        .zip(["baseColor", "normal", "occlusion"])
    {
        let named = warning.message.contains(slot) && warning.message.contains("rock");
        assert!(named, "{}", warning.message);
    }
    assert_eq!(
        warnings(&rich().load_with(&LoadOptions::default()).expect("loads")),
        [""; 0]
    );
}

#[test]
fn the_manual_lists_every_supported_extension() {
    let manual = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gltf.md");
    let text = std::fs::read_to_string(manual).expect("the manual");
    let rows = text
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    let names: Vec<_> = rows.map(|(name, _)| name).collect();
    assert_eq!(names, Vec::from_iter(supported_extensions()));
}
