//! Material layers of the extensions of glTF whose numbers the table of materials names.

use glam::Vec3;

use super::{
    Fault, Notes,
    ranges::Numbers,
    schema::{MaterialExtensions, layer_field},
};
use crate::{LayerTexture, Material, normal_uv::NormalUv};
use reflet_scene::{
    desc::{EMISSIVE_STRENGTH, MaterialDesc, MaterialNumbers, reflectivity_of},
    number::{Field, Form},
    range::LIMIT,
};

/// Reads the factors into `out`, and returns the layers that the material then has. `moves` tells whether an animation
/// of the file moves the value of a key of scene text: such a layer is kept even if it has no effect at rest.
pub fn read(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    numbers: &mut Numbers<'_>,
) -> Result<MaterialDesc, Fault> {
    let passes = extensions.has("transmission");
    let has_medium = passes || extensions.has("volume_scatter");
    let ior = index(extensions, out, numbers)?;
    let maps = extensions.textures();
    let has_map = |texture: LayerTexture| maps[texture as usize].is_some();
    let mut desc = MaterialDesc::default();
    for (path, key, own) in extensions.numbers() {
        let is_read = path != EMISSIVE_STRENGTH && (has_medium || !path.starts_with("volume/"));
        let Some(field) = layer_field(key).filter(|_| is_read) else {
            continue;
        };
        let value = number(field, path, own, numbers)?;
        let is_kept = match key {
            "specular" => has_map(LayerTexture::Specular),
            "specular_color" => has_map(LayerTexture::SpecularColor),
            _ => false,
        };
        if (field.off() != Some(value) || is_kept || moves(key)) && value.is_finite() {
            (field.put)(&mut desc, value);
        }
    }
    out.edge_tint = extensions.edge_tint;
    // Transmissive materials keep their index of refraction, even where they reflect nothing.
    if desc.specular == Some(0.0) && !moves("specular") && !passes && !out.edge_tint {
        out.reflectivity = 0.0;
        (desc.specular, desc.specular_color) = (None, None);
    }
    out.numbers.set(&desc);
    let mut own = |path: &str, other: f32, most: f32| {
        let (_, name) = path.split_once('/').unwrap_or_default();
        numbers.one(name, extensions.number(path), other, most)
    };
    if passes {
        // An infinite index lets nothing through.
        out.ior = if ior == 0.0 { 1.5 } else { ior };
    }
    if has_medium {
        out.solid = own("volume/thicknessFactor", 0.0, f32::INFINITY)? > 0.0;
    }
    out.iridescence_least_nm = own(
        "iridescence/iridescenceThicknessMinimum",
        100.0,
        f32::INFINITY,
    )?;
    let coat_map = maps[LayerTexture::ClearcoatNormal as usize];
    let scale = coat_map.and_then(|map| map.scale).map(|scale| [scale]);
    [out.clearcoat_normal_scale] = numbers.finite("clearcoatNormalTexture/scale", scale, [1.0])?;
    Ok(desc)
}

/// Index of refraction, with the reflectivity that follows from it; 0 stands for an infinite one.
fn index(
    extensions: &MaterialExtensions,
    out: &mut Material,
    numbers: &mut Numbers<'_>,
) -> Result<f32, Fault> {
    let own = extensions.number("ior/ior");
    let message = || {
        format!(
            "ior is {}, expected 0 or at least 1",
            own.unwrap_or_default()
        )
    };
    let is_right = |v: &[f32]| v[0] == 0.0 || v[0] >= 1.0 && v[0].is_finite();
    let [ior] = numbers.checked(own.map(|ior| [ior]), [1.5], is_right, message)?;
    out.has_index = ior > 0.0 && extensions.has("ior");
    out.reflectivity = if ior == 0.0 {
        1.0
    } else {
        reflectivity_of(ior)
    };
    Ok(ior)
}

/// A number of a layer in the unit of scene text; the material's default where the file has none.
fn number(
    field: &Field<MaterialDesc>,
    path: &str,
    own: Option<[f32; 3]>,
    numbers: &mut Numbers<'_>,
) -> Result<Vec3, Fault> {
    let (_, name) = path.split_once('/').unwrap_or_default();
    let plain = (field.get)(&MaterialNumbers::default().desc()).or(field.off());
    // glTF's default distance of attenuation is infinite; JSON cannot write it.
    let plain = plain.unwrap_or(Vec3::INFINITY);
    let least = field.range.min as f32;
    let is_above = field.range.above_min;
    let most = if field.range.max < LIMIT {
        field.range.max as f32
    } else {
        f32::INFINITY
    };
    if field.form == Form::Color {
        let color = numbers.clamped(name, own, plain.to_array(), most.min(1e4))?;
        return Ok(color.into());
    }
    let (own, plain) = (own.map(|[x, ..]| [x]), [plain.x]);
    let [x] = if least < 0.0 {
        numbers.finite(name, own, plain)?
    } else if least == 0.0 && !is_above {
        numbers.clamped(name, own, plain, most)?
    } else {
        let may_be_infinite = plain[0].is_infinite();
        let is_right = |v: &[f32]| {
            (v[0] > least || v[0] == least && !is_above) && (v[0].is_finite() || may_be_infinite)
        };
        let message = || match own {
            Some([x]) if !is_above => format!("{name} is {x}, expected at least {least}"),
            _ => format!("{name} must be above {least}"),
        };
        numbers.checked(own, plain, is_right, message)?
    };
    let is_angle = field.key.ends_with("_deg");
    Ok(Vec3::splat(if is_angle { x.to_degrees() } else { x }))
}

/// Warns of scattering inside of a solid that has no effect.
pub fn note_idle_scattering(material: &Material, place: &str, notes: &mut Notes) {
    let what = if !material.solid {
        "materials have the extension \"KHR_materials_volume_scatter\", which is ignored without a thicknessFactor above 0"
    } else if material.attenuation_distance_m.is_none() || material.attenuation_color == Vec3::ONE {
        "materials have the extension \"KHR_materials_volume_scatter\", which is ignored without an attenuationDistance \
         and an attenuationColor below white"
    } else {
        "materials have the extension \"KHR_materials_volume_scatter\", which is ignored where no light enters, by \
         \"KHR_materials_diffuse_transmission\" or \"KHR_materials_transmission\""
    };
    let is_idle = !material.scatters() || material.extinction() == Vec3::ZERO;
    let count = u64::from(is_idle && material.scattering_color.is_some());
    notes.add("extension-ignored", count, what, place);
}

/// Warns of a clear coat whose normal map has other texture coordinates than the material's, as vertices have only
/// one tangent each.
pub fn note_shared_tangents(material: &Material, place: &str, notes: &mut Notes) {
    let own = material.normal_texture.as_ref().map(NormalUv::from_map);
    let coat = material.layer_texture(LayerTexture::ClearcoatNormal);
    let coat = coat.as_ref().map(NormalUv::from_map);
    let differs = own.zip(coat).is_some_and(|(own, coat)| own != coat);
    let what = "materials have a clear coat whose normal map has other texture coordinates than their own; tangents \
                follow the latter";
    notes.add("tangents-shared", u64::from(differs), what, place);
}
