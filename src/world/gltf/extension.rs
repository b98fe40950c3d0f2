//! glTF extensions: supported, safely ignored, and ignored with a warning.

use super::{Fault, Notes, schema::Root};

/// Extensions that may stand in `extensionsRequired`.
pub const SUPPORTED: [&str; 11] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness", // approximated, with a warning
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_materials_variants", // without a chosen variant the default materials show, as specified
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Ignored: the picture is the same, or the file has a fallback.
const HARMLESS: [&str; 4] = [
    "EXT_meshopt_compression",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_xmp_json_ld",
];

/// A named error for every required extension that is not supported.
pub fn check_required(required: &[String]) -> Result<(), Fault> {
    let unknown: Vec<_> = required
        .iter()
        .filter(|name| !SUPPORTED.contains(&name.as_str()))
        .map(|name| format!("\"{name}\""))
        .collect();
    if unknown.is_empty() {
        return Ok(());
    }
    Err(Fault::new(
        "extension-unsupported",
        format!(
            "the file requires {}, which is not supported",
            unknown.join(", ")
        ),
    )
    .help(format!(
        "export the file without them; supported are {}",
        SUPPORTED.join(", ")
    )))
}

/// Warns about ignored extensions that change the appearance.
pub fn note_ignored(root: &Root, notes: &mut Notes) {
    for name in &root.extensions_used {
        let name = name.as_str();
        if !SUPPORTED.contains(&name) && !HARMLESS.contains(&name) {
            notes.add(
                "extension-ignored",
                1,
                "extension is ignored",
                &format!("\"{name}\""),
            );
        }
    }
}
