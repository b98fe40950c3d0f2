//! Material layers of the extensions KHR_materials_ior, _specular, _sheen, _transmission, _volume, _dispersion,
//! _clearcoat, _iridescence and _anisotropy.

use glam::Vec3;

use super::{Fault, Notes, ranges::Numbers, schema::MaterialExtensions};
use crate::{LAYER_SLOTS, LayerTexture, Material, normal_uv::NormalUv};
use reflet_scene::range::DISPERSION;

/// Reads the factors into `out`, and whether each texture has an effect. `moves` tells whether an animation of the file moves the value of a
/// key of scene text: such a layer is kept even if it has no effect at rest.
pub fn read(
    extensions: &MaterialExtensions,
    out: &mut Material,
    moves: &dyn Fn(&str) -> bool,
    numbers: &mut Numbers<'_>,
) -> Result<[bool; LAYER_SLOTS], Fault> {
    let mut layers = Layers {
        extensions,
        out,
        moves,
        numbers,
    };
    let ior = layers.ior()?;
    layers.specular(ior)?;
    layers.sheen()?;
    layers.transmission(ior)?;
    layers.dispersion()?;
    layers.clearcoat()?;
    layers.iridescence()?;
    layers.anisotropy()?;
    Ok([
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
    ])
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

/// Layers of a material while they are read.
struct Layers<'a, 'n> {
    extensions: &'a MaterialExtensions,
    out: &'a mut Material,
    moves: &'a dyn Fn(&str) -> bool,
    numbers: &'a mut Numbers<'n>,
}

impl Layers<'_, '_> {
    /// Index of refraction; 0 stands for an infinite one.
    fn ior(&mut self) -> Result<f32, Fault> {
        let own = self.extensions.ior.as_ref().and_then(|e| e.ior);
        let message = || {
            format!(
                "ior is {}, expected 0 or at least 1",
                own.unwrap_or_default()
            )
        };
        let is_right = |v: &[f32]| v[0] == 0.0 || v[0] >= 1.0 && v[0].is_finite();
        let ior = (self.numbers).checked(own.map(|ior| [ior]), [1.5], is_right, message)?;
        Ok(ior[0])
    }

    fn specular(&mut self, ior: f32) -> Result<(), Fault> {
        let (extensions, out, numbers) = (self.extensions, &mut *self.out, &mut *self.numbers);
        out.has_index = ior > 0.0 && extensions.ior.is_some();
        out.reflectivity = match ior {
            0.0 => 1.0,
            ior => ((ior - 1.0) / (ior + 1.0)).powi(2),
        };
        let Some(specular) = &extensions.specular else {
            return Ok(());
        };
        let factor = numbers.unit("specularFactor", specular.specular_factor, 1.0)?;
        let is_kept = (self.moves)("specular");
        // Transmissive materials keep their index of refraction, even where they reflect nothing.
        if factor <= 0.0 && !is_kept && extensions.transmission.is_none() {
            out.reflectivity = 0.0;
            return Ok(());
        }
        let is_kept = is_kept || specular.specular_texture.is_some();
        out.specular = (factor < 1.0 || is_kept).then_some(factor);
        let own = specular.specular_color_factor;
        let color = Vec3::from(numbers.clamped("specularColorFactor", own, [1.0; 3], 1e4)?);
        let is_kept = specular.specular_color_texture.is_some() || (self.moves)("specular_color");
        out.specular_color = (color != Vec3::ONE || is_kept).then_some(color);
        Ok(())
    }

    fn sheen(&mut self) -> Result<(), Fault> {
        let Some(sheen) = &self.extensions.sheen else {
            return Ok(());
        };
        let (out, numbers) = (&mut *self.out, &mut *self.numbers);
        let own = sheen.sheen_color_factor;
        let color = Vec3::from(numbers.clamped("sheenColorFactor", own, [0.0; 3], 1.0)?);
        out.sheen_color = (color != Vec3::ZERO || (self.moves)("sheen_color")).then_some(color);
        let own = sheen.sheen_roughness_factor;
        out.sheen_roughness = numbers.unit("sheenRoughnessFactor", own, 0.0)?;
        Ok(())
    }

    fn transmission(&mut self, ior: f32) -> Result<(), Fault> {
        let Some(transmission) = &self.extensions.transmission else {
            return Ok(());
        };
        let (out, numbers) = (&mut *self.out, &mut *self.numbers);
        let own = transmission.transmission_factor;
        let share = numbers.unit("transmissionFactor", own, 0.0)?;
        out.transmission = (share > 0.0 || (self.moves)("transmission")).then_some(share);
        // An infinite index lets nothing through.
        out.ior = if ior == 0.0 { 1.5 } else { ior };
        let Some(volume) = &self.extensions.volume else {
            return Ok(());
        };
        let own = volume.thickness_factor;
        out.solid = numbers.one("thicknessFactor", own, 0.0, f32::INFINITY)? > 0.0;
        let own = volume.attenuation_color;
        let color = numbers.clamped("attenuationColor", own, [1.0; 3], 1.0)?;
        out.attenuation_color = color.into();
        // glTF's default is an infinite distance; JSON cannot write it.
        let own = volume.attenuation_distance.map(|distance| [distance]);
        let message = || "attenuationDistance must be above 0".into();
        let distance = numbers.checked(own, [f32::INFINITY], |v| v[0] > 0.0, message)?;
        out.attenuation_distance_m = Some(distance[0]).filter(|d| d.is_finite());
        Ok(())
    }

    fn clearcoat(&mut self) -> Result<(), Fault> {
        let Some(coat) = &self.extensions.clearcoat else {
            return Ok(());
        };
        let (out, numbers) = (&mut *self.out, &mut *self.numbers);
        let strength = numbers.unit("clearcoatFactor", coat.clearcoat_factor, 0.0)?;
        out.clearcoat = (strength > 0.0 || (self.moves)("clearcoat")).then_some(strength);
        let own = coat.clearcoat_roughness_factor;
        out.clearcoat_roughness = numbers.unit("clearcoatRoughnessFactor", own, 0.0)?;
        let own = coat.clearcoat_normal_texture.as_ref().and_then(|t| t.scale);
        let scale = own.map(|scale| [scale]);
        [out.clearcoat_normal_scale] =
            numbers.finite("clearcoatNormalTexture/scale", scale, [1.0])?;
        Ok(())
    }

    fn dispersion(&mut self) -> Result<(), Fault> {
        let Some(dispersion) = &self.extensions.dispersion else {
            return Ok(());
        };
        let (own, most) = (dispersion.dispersion, DISPERSION.max as f32);
        let value = self.numbers.one("dispersion", own, 0.0, most)?;
        self.out.dispersion = (value > 0.0 || (self.moves)("dispersion")).then_some(value);
        Ok(())
    }

    fn iridescence(&mut self) -> Result<(), Fault> {
        let Some(film) = &self.extensions.iridescence else {
            return Ok(());
        };
        let (out, numbers) = (&mut *self.out, &mut *self.numbers);
        let strength = numbers.unit("iridescenceFactor", film.iridescence_factor, 0.0)?;
        out.iridescence = (strength > 0.0 || (self.moves)("iridescence")).then_some(strength);
        let own = film.iridescence_ior;
        let is_right = |v: &[f32]| v[0] >= 1.0 && v[0].is_finite();
        let message = || {
            let ior = own.unwrap_or_default();
            format!("iridescenceIor is {ior}, expected at least 1")
        };
        [out.iridescence_ior] = numbers.checked(own.map(|ior| [ior]), [1.3], is_right, message)?;
        let mut thickness = |key: &str, own, other| numbers.one(key, own, other, f32::INFINITY);
        let (least, most) = (
            film.iridescence_thickness_minimum,
            film.iridescence_thickness_maximum,
        );
        out.iridescence_least_nm = thickness("iridescenceThicknessMinimum", least, 100.0)?;
        out.iridescence_thickness_nm = thickness("iridescenceThicknessMaximum", most, 400.0)?;
        Ok(())
    }

    fn anisotropy(&mut self) -> Result<(), Fault> {
        let Some(anisotropy) = &self.extensions.anisotropy else {
            return Ok(());
        };
        let (out, numbers) = (&mut *self.out, &mut *self.numbers);
        let strength = numbers.unit("anisotropyStrength", anisotropy.anisotropy_strength, 0.0)?;
        out.anisotropy = (strength > 0.0 || (self.moves)("anisotropy")).then_some(strength);
        let own = anisotropy.anisotropy_rotation.map(|rotation| [rotation]);
        let [rotation] = numbers.finite("anisotropyRotation", own, [0.0])?;
        out.anisotropy_rotation_deg = rotation.to_degrees();
        Ok(())
    }
}
