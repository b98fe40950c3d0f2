//! What passes through a material and what lies over it: KHR_materials_transmission, _volume and
//! _clearcoat.

use glam::Vec3;

use super::{Fault, Notes, finite, schema::MaterialExtensions};
use crate::world::Material;

/// Reads the factors into `out`; their textures are not used, with a warning.
pub fn read(
    extensions: &MaterialExtensions,
    out: &mut Material,
    place: &str,
    notes: &mut Notes,
) -> Result<(), Fault> {
    transmission(extensions, out)?;
    clearcoat(extensions, out)?;
    let has_texture = extensions
        .transmission
        .as_ref()
        .is_some_and(|t| t.transmission_texture.is_some())
        || extensions.clearcoat.as_ref().is_some_and(|c| {
            c.clearcoat_texture.is_some()
                || c.clearcoat_roughness_texture.is_some()
                || c.clearcoat_normal_texture.is_some()
        });
    let what = "materials have a texture of their transmission or clear coat, of which only the factor \
                is used";
    notes.add("layer-texture-ignored", u64::from(has_texture), what, place);
    Ok(())
}

fn transmission(extensions: &MaterialExtensions, out: &mut Material) -> Result<(), Fault> {
    let Some(transmission) = &extensions.transmission else {
        return Ok(());
    };
    let share = transmission.transmission_factor.unwrap_or(0.0);
    check(&[share], "transmissionFactor must be finite")?;
    out.transmission = (share > 0.0).then_some(share.min(1.0));
    // 0 stands for an infinite index, which lets nothing through.
    let ior = extensions.ior.as_ref().and_then(|e| e.ior).unwrap_or(1.5);
    out.ior = if ior == 0.0 { 1.5 } else { ior };
    let Some(volume) = &extensions.volume else {
        return Ok(());
    };
    let thickness = volume.thickness_factor.unwrap_or(0.0);
    check(&[thickness], "thicknessFactor must be finite")?;
    out.solid = thickness > 0.0;
    let color = volume.attenuation_color.unwrap_or([1.0; 3]);
    check(&color, "attenuationColor must be finite")?;
    out.attenuation_color = Vec3::from_array(color).clamp(Vec3::ZERO, Vec3::ONE);
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

fn clearcoat(extensions: &MaterialExtensions, out: &mut Material) -> Result<(), Fault> {
    let Some(coat) = &extensions.clearcoat else {
        return Ok(());
    };
    let strength = coat.clearcoat_factor.unwrap_or(0.0);
    let roughness = coat.clearcoat_roughness_factor.unwrap_or(0.0);
    check(&[strength, roughness], "clearcoat factors must be finite")?;
    out.clearcoat = (strength > 0.0).then_some(strength.min(1.0));
    out.clearcoat_roughness = roughness.clamp(0.0, 1.0);
    Ok(())
}

fn check(numbers: &[f32], message: &str) -> Result<(), Fault> {
    if finite(numbers) {
        return Ok(());
    }
    Err(Fault::new("gltf-material", message))
}
