//! glTF materials as [`Material`]: core metallic-roughness and supported extensions.

use std::path::Path;

use glam::Vec3;

use super::{
    Fault, Model, Notes,
    accessor::Data,
    animation::moved_material_keys,
    label, layers,
    ranges::Numbers,
    schema::{self, Root},
    specular_glossiness,
    texture_ref::{Slot, Textures},
    uri::{self, Sandbox},
};
use crate::{FILE_TEXTURES, Material};
use reflet_scene::desc::{EMISSIVE_STRENGTH, MaterialNumbers};

/// Reads all materials into `model`, the default material last.
pub fn read(
    root: &Root,
    data: &Data<'_>,
    folder: &Path,
    sandbox: &Sandbox,
    model: &mut Model,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let mut textures = Textures::new(root, data, folder, sandbox);
    let moved = moved_material_keys(root);
    for (i, material) in root.materials.iter().enumerate() {
        let place = label("material", i, material.name.as_deref());
        let moves = |key: &str| moved.contains(&(i, key));
        let read = convert(material, i, &place, &moves, &mut textures, notes);
        let mut read = read.map_err(|f| f.placed(&place))?;
        model.uv_sets.push(choose_uv_sets(&mut read, &place, notes));
        let name = material
            .name
            .clone()
            .unwrap_or_else(|| format!("material {i}"));
        model.materials.push(Material { name, ..read });
    }
    // Primitives without a material get glTF's defaults: white, metallic 1, roughness 1.
    let default = schema::Material::default();
    let default = convert(
        &default,
        root.materials.len(),
        "",
        &|_| false,
        &mut textures,
        notes,
    )?;
    model.materials.push(Material {
        name: "default".into(),
        ..default
    });
    model.uv_sets.push([0, 1]);
    model.images = textures.images;
    Ok(())
}

/// Chooses the two sets of texture coordinates that meshes with this material keep; its textures refer to them as 0
/// and 1 from then on.
fn choose_uv_sets(material: &mut Material, place: &str, notes: &mut Notes) -> [u32; 2] {
    let mut textures = material.texture_slots();
    let mut used: Vec<u32> = textures
        .iter()
        .flat_map(|t| t.as_ref())
        .map(|t| t.uv_set)
        .collect();
    used.sort_unstable();
    used.dedup();
    let sets = match used[..] {
        [] | [0] => [0, 1],
        [0, one] | [one] => [0, one],
        [first, second, ..] => [first, second],
    };
    for texture in textures.iter_mut().filter_map(|t| t.as_mut()) {
        let slot = sets.iter().position(|set| *set == texture.uv_set);
        let what = "textures use a third set of texture coordinates; the first is used";
        notes.add("uv-set-unsupported", u64::from(slot.is_none()), what, place);
        texture.uv_set = slot.unwrap_or(0) as u32;
    }
    sets
}

/// Key in a material's extras with an object that marks a mesh light, whose emission lights the scene.
const MESH_LIGHT: &str = "mesh_light";

fn convert(
    material: &schema::Material,
    index: usize,
    place: &str,
    moves: &dyn Fn(&str) -> bool,
    textures: &mut Textures<'_>,
    notes: &mut Notes,
) -> Result<Material, Fault> {
    let mut numbers = Numbers {
        place,
        is_lenient: textures.root.is_lenient,
        notes: Notes::default(),
    };
    let mut out = factors(material, &mut numbers)?;
    let kept = layers::read(&material.extensions, &mut out, moves, &mut numbers)?;
    let textures_of = material.textures().into_iter().zip(FILE_TEXTURES);
    for (i, (info, file)) in textures_of.enumerate() {
        let Some(info) = info.filter(|_| file.needs.is_empty() || kept.has(file.needs)) else {
            continue;
        };
        let slot = Slot {
            material: place,
            index,
            path: file.path,
        };
        *out.texture_slots()[i] = textures.reference(info, file.is_color, &slot, notes)?;
    }
    layers::note_shared_tangents(&out, place, notes);
    out.alpha_cutoff = alpha(material, &mut numbers)?;
    let is_marked = (material.extras.get(MESH_LIGHT)).is_some_and(serde_json::Value::is_object);
    // Exporters have no other mark for lamps than emission brighter than white.
    out.is_mesh_light = is_marked || out.emission.max_element() > 1.0;
    out.light = out.is_mesh_light;
    out.blended = material.alpha_mode.as_deref() == Some("BLEND");
    layers::note_idle_scattering(&out, place, notes);
    if let Some(gloss) = &material.extensions.specular_glossiness {
        specular_glossiness::convert(gloss, &mut out, textures, index, &mut numbers)?;
    }
    notes.merge(numbers.notes);
    if material.extensions.unlit.is_some() {
        out = unlit(&out);
    }
    Ok(out)
}

/// The factors of core glTF and KHR_materials_emissive_strength.
fn factors(material: &schema::Material, numbers: &mut Numbers<'_>) -> Result<Material, Fault> {
    let pbr = &material.pbr_metallic_roughness;
    let own = pbr.base_color_factor;
    let base_color = numbers.clamped("baseColorFactor", own, [1.0; 4], 1.0)?;
    // Factors above 1 are kept, though glTF allows at most 1.
    let (own, endless) = (material.emissive_factor, f32::INFINITY);
    let emission = Vec3::from(numbers.clamped("emissiveFactor", own, [0.0; 3], endless)?);
    let strength = material.extensions.number(EMISSIVE_STRENGTH);
    let strength = strength.map(|v| [v]);
    let is_right = |v: &[f32]| v[0] >= 0.0 && v[0].is_finite();
    let message = || "emissiveStrength must be 0 or more".into();
    let [strength] = numbers.checked(strength, [1.0], is_right, message)?;
    let scale = material.normal_texture.as_ref().and_then(|t| t.scale);
    let scale = scale.map(|scale| [scale]);
    let occlusion = material.occlusion_texture.as_ref();
    let occlusion = occlusion.and_then(|t| t.strength);
    Ok(Material {
        base_color: base_color.into(),
        numbers: MaterialNumbers {
            metallic: numbers.unit("metallicFactor", pbr.metallic_factor, 1.0)?,
            roughness: numbers.unit("roughnessFactor", pbr.roughness_factor, 1.0)?,
            normal_scale: numbers.finite("normalTexture/scale", scale, [1.0])?[0],
            occlusion_strength: numbers.unit("occlusionTexture/strength", occlusion, 1.0)?,
            ..MaterialNumbers::default()
        },
        // The cap keeps products finite.
        emission: (emission * strength).min(Vec3::splat(1e30)),
        double_sided: material.double_sided,
        ..Material::default()
    })
}

fn alpha(material: &schema::Material, numbers: &mut Numbers<'_>) -> Result<Option<f32>, Fault> {
    match material.alpha_mode.as_deref().unwrap_or("OPAQUE") {
        "OPAQUE" | "BLEND" => Ok(None),
        "MASK" => {
            let (own, endless) = (material.alpha_cutoff, f32::INFINITY);
            numbers.one("alphaCutoff", own, 0.5, endless).map(Some)
        }
        other => {
            let other = uri::shorten(other);
            numbers.wrong(format!("alphaMode \"{other}\" is unknown"))?;
            Ok(None)
        }
    }
}

/// Applies KHR_materials_unlit: only the base color and its alpha remain.
fn unlit(material: &Material) -> Material {
    Material {
        emission: Vec3::ZERO,
        emission_texture: None,
        light: false,
        is_mesh_light: false,
        ..material.without_light()
    }
}
