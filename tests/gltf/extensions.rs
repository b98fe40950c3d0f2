//! Extensions that files require.

use crate::kit::{Doc, Folder, scene, warnings};
use reflet::world::{
    gltf::SUPPORTED_EXTENSIONS,
    load::{LoadOptions, load},
};
use serde_json::json;

fn lenient(doc: &Doc) -> Result<reflet::world::World, Vec<reflet::scene::diagnostic::Diagnostic>> {
    let folder = Folder::new();
    folder.write("m.glb", doc.glb());
    let options = LoadOptions {
        lenient: true,
        ..LoadOptions::default()
    };
    load(&scene(&folder.0, "m.glb"), &options)
}

#[test]
fn required_extensions_are_refused_by_name() {
    let mut doc = Doc::triangle();
    doc.json["extensionsRequired"] = json!(["KHR_texture_transform", "VENDOR_magic"]);
    for result in [doc.load(), lenient(&doc)] {
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
fn a_required_look_loads_when_asked() {
    let mut doc = Doc::triangle();
    let names = [
        "KHR_materials_diffuse_transmission",
        "VENDOR_materials_glow",
    ];
    doc.json["extensionsRequired"] = json!(names);
    let errors = doc.load().expect_err("unsupported");
    let help = errors[0].help.as_deref().expect("help");
    assert!(help.contains("--lenient"), "{help}");
    let world = lenient(&doc).expect("loads");
    assert_eq!(warnings(&world), ["extension-ignored"; 2]);
    for (warning, name) in world.warnings.iter().zip(names) {
        assert!(warning.message.contains(name), "{}", warning.message);
    }
}

#[test]
fn the_manual_lists_every_supported_extension() {
    let manual = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gltf.md");
    let text = std::fs::read_to_string(manual).expect("the manual");
    let rows = text
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    let names: Vec<_> = rows.map(|(name, _)| name).collect();
    assert_eq!(names, SUPPORTED_EXTENSIONS);
}
