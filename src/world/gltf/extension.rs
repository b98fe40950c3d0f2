//! glTF extensions: supported, safely ignored, and ignored with a warning.

use std::{collections::BTreeSet, path::Path};

use super::{Fault, schema::Root, uri::shorten};
use reflet_scene::{desc::LAYER_NUMBERS, diagnostic::Diagnostic};

/// Supported extensions that are not numbers of materials.
const OTHERS: [&str; 17] = [
    "EXT_lights_image_based",
    "EXT_materials_specular_edge_color",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "GOOGLE_texture_basis",
    "KHR_draco_mesh_compression",
    "KHR_gaussian_splatting", // shown as points, with a warning
    "KHR_lights_punctual",
    "KHR_materials_pbrSpecularGlossiness", // approximated, with a warning
    "KHR_materials_unlit",
    "KHR_materials_variants", // without a chosen variant the default materials show, as specified
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Supported extensions, which files may list in `extensionsRequired`, sorted.
pub fn supported_extensions() -> BTreeSet<String> {
    let of_number = |(path, _): &(&str, _)| {
        let extension = path.split('/').next().unwrap_or_default();
        format!("KHR_materials_{extension}")
    };
    let numbers = LAYER_NUMBERS.iter().map(of_number);
    numbers.chain(OTHERS.map(str::to_owned)).collect()
}

/// Extensions that need no warning: the picture is the same without them, or the file has a fallback.
const HARMLESS: [&str; 7] = [
    "FB_ngon_encoding", // marks fans of triangles as polygons
    "KHR_animation_pointer",
    "KHR_xmp_json_ld",
    "VRMC_node_constraint", // moves nodes after others that a program poses
    "VRMC_springBone",      // swings of hair and clothes, at rest as the nodes are
    "VRMC_springBone_extended_collider",
    "VRMC_vrm", // names bones and expressions of an avatar
];

/// Whether an extension can only change how things look, as far as its name tells: materials,
/// textures, lights, and avatars of VRM 0.
fn is_look(name: &str) -> bool {
    let parts = ["_materials_", "_texture_", "_lights_"];
    name == "VRM" || parts.iter().any(|part| name.contains(part))
}

/// Refuses unsupported extensions in `extensionsRequired`; without `strict`, extensions that only change the look are
/// not refused.
pub fn check_required(required: &[String], strict: bool) -> Result<(), Fault> {
    let names = required.iter().map(String::as_str);
    let is_refused = |name: &&str| is_ignored(name) && (strict || !is_look(name));
    let refused: Vec<_> = names.filter(is_refused).collect();
    if refused.is_empty() {
        return Ok(());
    }
    let instead = if refused.iter().all(|name| is_look(name)) {
        "leave --strict out to load it without them"
    } else {
        "export the file without them"
    };
    let quote = |name: &&str| format!("\"{}\"", shorten(name));
    let quoted: Vec<_> = refused.iter().map(quote).collect();
    Err(Fault::new(
        "extension-unsupported",
        format!(
            "the file requires {}, which is not supported",
            quoted.join(", ")
        ),
    )
    .help(format!(
        "{instead}; supported are {}",
        Vec::from_iter(supported_extensions()).join(", ")
    )))
}

fn is_ignored(name: &str) -> bool {
    !supported_extensions().contains(name) && !HARMLESS.contains(&name)
}

/// A warning for each ignored extension that changes the appearance.
pub fn ignored(root: &Root, file: &Path) -> Vec<Diagnostic> {
    let all = root.extensions_used.iter().chain(&root.extensions_required);
    let used: BTreeSet<&str> = all.map(String::as_str).collect();
    let warning = |name: &str| {
        let is_required = root.extensions_required.iter().any(|other| other == name);
        let (kind, text) = match is_required {
            true => (
                "extension-left-out",
                ", though the file requires it, as it only adds a look",
            ),
            false => ("extension-ignored", ""),
        };
        let text = format!("extension \"{}\" is ignored{text}", shorten(name));
        Diagnostic::in_file(kind, file, text).warning()
    };
    let ignored = used.into_iter().filter(|name| is_ignored(name));
    ignored.map(warning).collect()
}
