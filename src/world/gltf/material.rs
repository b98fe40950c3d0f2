//! glTF materials as [`Material`]: core metallic-roughness and supported extensions.

use std::path::Path;

use glam::{Vec3, Vec4};

use super::{
    Fault, Model, Notes,
    accessor::Data,
    animation::moved_material_keys,
    finite, label, layers,
    lenient::{LeftOut, forgiven},
    ranges::Ranges,
    schema::{self, Root, TextureInfo},
    specular_glossiness,
    texture_ref::{Slot, Textures},
    uri::{self, Sandbox},
};
use crate::Material;
use reflet_scene::desc::MaterialNumbers;

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
    let mut ranges = Ranges::default();
    let root = textures.root;
    let left_out = LeftOut {
        name: "property-left-out",
        what: "properties of materials are wrong, and left out with others of the same extensions",
        place,
    };
    let plain = || Material {
        base_color: Vec4::ONE,
        double_sided: material.double_sided,
        ..Material::default()
    };
    let factors = factors(material, &mut ranges);
    let mut out = forgiven(root, factors, plain(), &left_out, notes)?;
    let pbr = &material.pbr_metallic_roughness;
    let mut texture = |info: &Option<TextureInfo>, srgb: bool, path: &str| {
        let slot = Slot {
            material: place,
            index,
            path,
        };
        let found = info
            .as_ref()
            .map(|info| textures.reference(info, srgb, &slot, notes));
        found.transpose().map(Option::flatten)
    };
    let core = "pbrMetallicRoughness";
    let base_color = &pbr.base_color_texture;
    out.base_color_texture = texture(base_color, true, &format!("{core}/baseColorTexture"))?;
    let metallic_roughness = &pbr.metallic_roughness_texture;
    let path = format!("{core}/metallicRoughnessTexture");
    out.metallic_roughness_texture = texture(metallic_roughness, false, &path)?;
    out.normal_texture = texture(&material.normal_texture, false, "normalTexture")?;
    out.occlusion_texture = texture(&material.occlusion_texture, false, "occlusionTexture")?;
    out.emission_texture = texture(&material.emissive_texture, true, "emissiveTexture")?;
    let extensions = &material.extensions;
    let layers = layers::read(extensions, &mut out, moves, &mut ranges, &mut texture);
    forgiven(root, layers, (), &left_out, notes)?;
    layers::note_shared_tangents(&out, place, notes);
    let cutoff = alpha(material, &mut ranges);
    out.alpha_cutoff = forgiven(root, cutoff, None, &left_out, notes)?;
    out.is_mesh_light = (material.extras.get(MESH_LIGHT)).is_some_and(serde_json::Value::is_object);
    out.light = out.is_mesh_light;
    out.blended = material.alpha_mode.as_deref() == Some("BLEND");
    if let Some(gloss) = &material.extensions.specular_glossiness {
        let converted = specular_glossiness::convert(
            gloss,
            &mut out,
            textures,
            index,
            place,
            &mut ranges,
            notes,
        );
        forgiven(root, converted, (), &left_out, notes)?;
    }
    ranges.note(place, notes);
    if material.extensions.unlit.is_some() {
        out = unlit(&out);
    }
    Ok(out)
}

/// The factors of core glTF and KHR_materials_emissive_strength.
fn factors(material: &schema::Material, ranges: &mut Ranges) -> Result<Material, Fault> {
    let fault = |text: &str| Err(Fault::new("gltf-material", text));
    let pbr = &material.pbr_metallic_roughness;
    let base = pbr.base_color_factor.unwrap_or([1.0; 4]);
    let emission = material.emissive_factor.unwrap_or_default();
    let metallic = pbr.metallic_factor.unwrap_or(1.0);
    let roughness = pbr.roughness_factor.unwrap_or(1.0);
    if !(finite(&base) && finite(&emission) && finite(&[metallic, roughness])) {
        return fault("factors must be finite");
    }
    let strength = material.extensions.emissive_strength.as_ref();
    let strength = strength.and_then(|e| e.emissive_strength).unwrap_or(1.0);
    if !(strength >= 0.0 && strength.is_finite()) {
        return fault("emissiveStrength must be 0 or more");
    }
    let number = |info: &Option<TextureInfo>, get: fn(&TextureInfo) -> Option<f32>| {
        let number = info.as_ref().and_then(get);
        number.filter(|v| v.is_finite()).unwrap_or(1.0)
    };
    // Factors above 1 are kept, though glTF allows at most 1.
    let emission = Vec3::from_array(ranges.clamped("emissiveFactor", emission, f32::INFINITY));
    let occlusion = number(&material.occlusion_texture, |t| t.strength);
    Ok(Material {
        base_color: Vec4::from_array(ranges.clamped("baseColorFactor", base, 1.0)),
        numbers: MaterialNumbers {
            metallic: ranges.unit("metallicFactor", metallic),
            roughness: ranges.unit("roughnessFactor", roughness),
            normal_scale: number(&material.normal_texture, |t| t.scale),
            occlusion_strength: ranges.unit("occlusionTexture/strength", occlusion),
            ..MaterialNumbers::default()
        },
        // The cap keeps products finite.
        emission: (emission * strength).min(Vec3::splat(1e30)),
        double_sided: material.double_sided,
        ..Material::default()
    })
}

fn alpha(material: &schema::Material, ranges: &mut Ranges) -> Result<Option<f32>, Fault> {
    match material.alpha_mode.as_deref().unwrap_or("OPAQUE") {
        "OPAQUE" | "BLEND" => Ok(None),
        "MASK" => {
            let cutoff = material.alpha_cutoff.filter(|c| c.is_finite());
            let cutoff = [cutoff.unwrap_or(0.5)];
            let [cutoff] = ranges.clamped("alphaCutoff", cutoff, f32::INFINITY);
            Ok(Some(cutoff))
        }
        other => {
            let other = uri::shorten(other);
            Err(Fault::new(
                "gltf-material",
                format!("alphaMode \"{other}\" is unknown"),
            ))
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
