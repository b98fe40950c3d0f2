//! Material layers of the extensions KHR_materials_ior, _specular, _sheen, _transmission, _volume, _dispersion,
//! _clearcoat, _iridescence and _anisotropy.

use glam::Vec3;

use super::{
    Fault, Notes, finite,
    ranges::Ranges,
    schema::{MaterialExtensions, TextureInfo},
};
use crate::{LAYER_SLOTS, LayerTexture, Material, TextureRef, normal_uv::NormalUv};
use reflet_scene::range::DISPERSION;

/// Function that resolves a texture by its use in the file, whether it is a color, and its JSON keys (for
/// messages).
pub type FindTexture<'a> =
    dyn FnMut(&Option<TextureInfo>, bool, &str) -> Result<Option<TextureRef>, Fault> + 'a;

/// Reads the factors and textures into `out`. `moves` tells whether an animation of the file moves the value of a
/// key of scene text: such a layer is kept even if it has no effect at rest.
pub fn read(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
    texture: &mut FindTexture<'_>,
) -> Result<(), Fault> {
    specular(extensions, out, moves, ranges)?;
    sheen(extensions, out, moves, ranges)?;
    transmission(extensions, out, moves, ranges)?;
    dispersion(extensions, out, moves, ranges)?;
    clearcoat(extensions, out, moves, ranges)?;
    iridescence(extensions, out, moves, ranges)?;
    anisotropy(extensions, out, moves, ranges)?;
    let is_used = [
        out.specular.is_some(),
        out.specular_color.is_some(),
        out.sheen_color.is_some(),
        out.sheen_color.is_some(),
        out.transmission.is_some(),
        out.clearcoat.is_some(),
        out.clearcoat.is_some(),
        out.clearcoat.is_some(),
        out.iridescence.is_some(),
        out.iridescence.is_some(),
        out.anisotropy.is_some(),
    ];
    let places = textures(extensions).into_iter().zip(PATHS).zip(is_used);
    for (i, ((info, path), _)) in places.enumerate().filter(|(_, (_, used))| *used) {
        let srgb = [LayerTexture::SpecularColor, LayerTexture::SheenColor];
        let is_color = srgb.iter().any(|color| *color as usize == i);
        out.layer_textures[i] = texture(info, is_color, path)?;
    }
    Ok(())
}

/// Keys of the textures inside a material, in the order of [`LayerTexture`].
const PATHS: [&str; LAYER_SLOTS] = [
    "extensions/KHR_materials_specular/specularTexture",
    "extensions/KHR_materials_specular/specularColorTexture",
    "extensions/KHR_materials_sheen/sheenColorTexture",
    "extensions/KHR_materials_sheen/sheenRoughnessTexture",
    "extensions/KHR_materials_transmission/transmissionTexture",
    "extensions/KHR_materials_clearcoat/clearcoatTexture",
    "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
    "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
    "extensions/KHR_materials_iridescence/iridescenceTexture",
    "extensions/KHR_materials_iridescence/iridescenceThicknessTexture",
    "extensions/KHR_materials_anisotropy/anisotropyTexture",
];

/// The textures of the file, in the order of [`LayerTexture`].
pub fn textures(extensions: &MaterialExtensions) -> [&Option<TextureInfo>; LAYER_SLOTS] {
    let specular = extensions.specular.as_ref();
    let sheen = extensions.sheen.as_ref();
    let transmission = extensions.transmission.as_ref();
    let coat = extensions.clearcoat.as_ref();
    let film = extensions.iridescence.as_ref();
    let anisotropy = extensions.anisotropy.as_ref();
    [
        specular.map_or(&None, |s| &s.specular_texture),
        specular.map_or(&None, |s| &s.specular_color_texture),
        sheen.map_or(&None, |s| &s.sheen_color_texture),
        sheen.map_or(&None, |s| &s.sheen_roughness_texture),
        transmission.map_or(&None, |t| &t.transmission_texture),
        coat.map_or(&None, |c| &c.clearcoat_texture),
        coat.map_or(&None, |c| &c.clearcoat_roughness_texture),
        coat.map_or(&None, |c| &c.clearcoat_normal_texture),
        film.map_or(&None, |f| &f.iridescence_texture),
        film.map_or(&None, |f| &f.iridescence_thickness_texture),
        anisotropy.map_or(&None, |a| &a.anisotropy_texture),
    ]
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

fn specular(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
) -> Result<(), Fault> {
    let ior = extensions.ior.as_ref().and_then(|e| e.ior).unwrap_or(1.5);
    // 0 stands for an infinite index of refraction.
    if !(ior == 0.0 || ior >= 1.0 && ior.is_finite()) {
        return Err(Fault::new(
            "gltf-material",
            format!("ior is {ior}, expected 0 or at least 1"),
        ));
    }
    out.has_index = ior > 0.0 && extensions.ior.is_some();
    out.reflectivity = if ior == 0.0 {
        1.0
    } else {
        ((ior - 1.0) / (ior + 1.0)).powi(2)
    };
    let Some(specular) = &extensions.specular else {
        return Ok(());
    };
    let factor = specular.specular_factor.unwrap_or(1.0);
    let color = specular.specular_color_factor.unwrap_or([1.0; 3]);
    check(&color, "specular factors must be finite")?;
    check(&[factor], "specular factors must be finite")?;
    let factor = ranges.unit("specularFactor", factor);
    let is_kept = moves("specular");
    // Transmissive materials keep their index of refraction, even where they reflect nothing.
    if factor <= 0.0 && !is_kept && extensions.transmission.is_none() {
        out.reflectivity = 0.0;
        return Ok(());
    }
    let is_kept = is_kept || specular.specular_texture.is_some();
    out.specular = (factor < 1.0 || is_kept).then_some(factor);
    let color = Vec3::from_array(ranges.clamped("specularColorFactor", color, 1e4));
    let is_kept = specular.specular_color_texture.is_some() || moves("specular_color");
    out.specular_color = (color != Vec3::ONE || is_kept).then_some(color);
    Ok(())
}

fn sheen(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
) -> Result<(), Fault> {
    let Some(sheen) = &extensions.sheen else {
        return Ok(());
    };
    let color = sheen.sheen_color_factor.unwrap_or_default();
    let roughness = sheen.sheen_roughness_factor.unwrap_or(0.0);
    check(&color, "sheen factors must be finite")?;
    check(&[roughness], "sheen factors must be finite")?;
    let color = Vec3::from_array(ranges.clamped("sheenColorFactor", color, 1.0));
    out.sheen_color = (color != Vec3::ZERO || moves("sheen_color")).then_some(color);
    out.sheen_roughness = ranges.unit("sheenRoughnessFactor", roughness);
    Ok(())
}

fn transmission(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
) -> Result<(), Fault> {
    let Some(transmission) = &extensions.transmission else {
        return Ok(());
    };
    let share = transmission.transmission_factor.unwrap_or(0.0);
    check(&[share], "transmissionFactor must be finite")?;
    let share = ranges.unit("transmissionFactor", share);
    out.transmission = (share > 0.0 || moves("transmission")).then_some(share);
    // 0 stands for an infinite index of refraction, which lets nothing through.
    let ior = extensions.ior.as_ref().and_then(|e| e.ior).unwrap_or(1.5);
    out.ior = if ior == 0.0 { 1.5 } else { ior };
    let Some(volume) = &extensions.volume else {
        return Ok(());
    };
    let thickness = volume.thickness_factor.unwrap_or(0.0);
    check(&[thickness], "thicknessFactor must be finite")?;
    let [thickness] = ranges.clamped("thicknessFactor", [thickness], f32::INFINITY);
    out.solid = thickness > 0.0;
    let color = volume.attenuation_color.unwrap_or([1.0; 3]);
    check(&color, "attenuationColor must be finite")?;
    out.attenuation_color = Vec3::from_array(ranges.clamped("attenuationColor", color, 1.0));
    // glTF's default is an infinite distance; JSON cannot write it.
    let distance = volume.attenuation_distance;
    if distance.is_some_and(|d| d.is_nan() || d <= 0.0) {
        return Err(Fault::new(
            "gltf-material",
            "attenuationDistance must be above 0",
        ));
    }
    out.attenuation_distance_m = distance.filter(|d| d.is_finite());
    Ok(())
}

fn clearcoat(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
) -> Result<(), Fault> {
    let Some(coat) = &extensions.clearcoat else {
        return Ok(());
    };
    let strength = coat.clearcoat_factor.unwrap_or(0.0);
    let roughness = coat.clearcoat_roughness_factor.unwrap_or(0.0);
    check(&[strength, roughness], "clearcoat factors must be finite")?;
    let strength = ranges.unit("clearcoatFactor", strength);
    out.clearcoat = (strength > 0.0 || moves("clearcoat")).then_some(strength);
    out.clearcoat_roughness = ranges.unit("clearcoatRoughnessFactor", roughness);
    let scale = coat.clearcoat_normal_texture.as_ref().and_then(|t| t.scale);
    out.clearcoat_normal_scale = scale.filter(|s| s.is_finite()).unwrap_or(1.0);
    Ok(())
}

fn dispersion(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
) -> Result<(), Fault> {
    let Some(dispersion) = &extensions.dispersion else {
        return Ok(());
    };
    let value = dispersion.dispersion.unwrap_or(0.0);
    check(&[value], "dispersion must be finite")?;
    let [value] = ranges.clamped("dispersion", [value], DISPERSION.max as f32);
    out.dispersion = (value > 0.0 || moves("dispersion")).then_some(value);
    Ok(())
}

fn iridescence(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
) -> Result<(), Fault> {
    let Some(film) = &extensions.iridescence else {
        return Ok(());
    };
    let strength = film.iridescence_factor.unwrap_or(0.0);
    let ior = film.iridescence_ior.unwrap_or(1.3);
    let least = film.iridescence_thickness_minimum.unwrap_or(100.0);
    let most = film.iridescence_thickness_maximum.unwrap_or(400.0);
    let numbers = [strength, ior, least, most];
    check(&numbers, "iridescence factors must be finite")?;
    if ior < 1.0 {
        return Err(Fault::new(
            "gltf-material",
            format!("iridescenceIor is {ior}, expected at least 1"),
        ));
    }
    let strength = ranges.unit("iridescenceFactor", strength);
    out.iridescence = (strength > 0.0 || moves("iridescence")).then_some(strength);
    out.iridescence_ior = ior;
    let endless = f32::INFINITY;
    [out.iridescence_least_nm] = ranges.clamped("iridescenceThicknessMinimum", [least], endless);
    [out.iridescence_thickness_nm] = ranges.clamped("iridescenceThicknessMaximum", [most], endless);
    Ok(())
}

fn anisotropy(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    ranges: &mut Ranges,
) -> Result<(), Fault> {
    let Some(anisotropy) = &extensions.anisotropy else {
        return Ok(());
    };
    let strength = anisotropy.anisotropy_strength.unwrap_or(0.0);
    let rotation = anisotropy.anisotropy_rotation.unwrap_or(0.0);
    check(&[strength, rotation], "anisotropy factors must be finite")?;
    let strength = ranges.unit("anisotropyStrength", strength);
    out.anisotropy = (strength > 0.0 || moves("anisotropy")).then_some(strength);
    out.anisotropy_rotation_deg = rotation.to_degrees();
    Ok(())
}

fn check(numbers: &[f32], message: &str) -> Result<(), Fault> {
    if finite(numbers) {
        return Ok(());
    }
    Err(Fault::new("gltf-material", message))
}
