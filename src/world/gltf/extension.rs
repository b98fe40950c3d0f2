//! glTF extensions: supported, safely ignored, and ignored with a warning.

use std::{collections::BTreeSet, path::Path};

use super::{Fault, schema::Root, uri::shorten};
use reflet_scene::diagnostic::{Diagnostic, Severity};

/// Supported extensions, which files may list in `extensionsRequired`.
pub const SUPPORTED: [&str; 25] = [
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_gaussian_splatting", // shown as points, with a warning
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness", // approximated, with a warning
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants", // without a chosen variant the default materials show, as specified
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Extensions that need no warning: the picture is the same without them, or the file has a fallback.
const HARMLESS: [&str; 2] = ["KHR_animation_pointer", "KHR_xmp_json_ld"];

/// Whether an extension can only change how things look, as far as its name tells: materials,
/// textures and lights.
fn is_look(name: &str) -> bool {
    ["_materials_", "_texture_", "_lights_"]
        .iter()
        .any(|part| name.contains(part))
}

/// Refuses unsupported extensions in `extensionsRequired`; with `lenient`, extensions that change only the look are
/// ignored as if they were optional.
pub fn check_required(required: &[String], lenient: bool) -> Result<(), Fault> {
    let unknown = || {
        let names = required.iter().map(String::as_str);
        names.filter(|name| !(SUPPORTED.contains(name) || lenient && is_look(name)))
    };
    let quoted: Vec<_> = unknown()
        .map(|name| format!("\"{}\"", shorten(name)))
        .collect();
    if quoted.is_empty() {
        return Ok(());
    }
    let instead = if unknown().all(is_look) {
        "add --lenient to load it without them"
    } else {
        "export the file without them"
    };
    Err(Fault::new(
        "extension-unsupported",
        format!(
            "the file requires {}, which is not supported",
            quoted.join(", ")
        ),
    )
    .help(format!("{instead}; supported are {}", SUPPORTED.join(", "))))
}

/// A warning for each ignored extension that changes the appearance.
pub fn ignored(root: &Root, file: &Path) -> Vec<Diagnostic> {
    let all = root.extensions_used.iter().chain(&root.extensions_required);
    let used: BTreeSet<&str> = all.map(String::as_str).collect();
    let is_ignored = |name: &&str| !SUPPORTED.contains(name) && !HARMLESS.contains(name);
    let warning = |name: &str| {
        let text = format!("extension \"{}\" is ignored", shorten(name));
        Diagnostic {
            severity: Severity::Warning,
            ..Diagnostic::in_file("extension-ignored", file, text)
        }
    };
    used.into_iter().filter(is_ignored).map(warning).collect()
}
