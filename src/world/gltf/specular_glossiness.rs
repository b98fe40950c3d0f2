//! KHR_materials_pbrSpecularGlossiness (archived) as metallic-roughness.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::{
    Fault, ImageSource, Notes,
    ranges::Numbers,
    schema::{SpecularGlossiness, TextureInfo},
    texture_ref::{Slot, Textures},
};
use crate::{Material, TextureRef};

/// Maps that are converted together, and their factors.
#[derive(Clone, Debug)]
pub struct SpecularGlossinessMaps {
    /// Map of diffuse color (sRGB) and opacity; `None` is white.
    pub diffuse: Option<ImageSource>,
    /// Map of specular color (sRGB), with glossiness in alpha; `None` is white.
    pub specular: Option<ImageSource>,
    /// Factors of the maps.
    pub factors: Factors,
    /// Metallic-roughness map that the conversion makes.
    pub part: Part,
}

/// A map of metallic-roughness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Base color and opacity.
    BaseColor,
    /// Green = roughness, blue = metallic.
    MetallicRoughness,
}

/// Factors of the material.
#[derive(Clone, Copy, Debug)]
pub struct Factors {
    /// Diffuse color, linear, 0 to 1.
    pub diffuse: Vec3,
    /// Specular color, linear, 0 to 1.
    pub specular: Vec3,
    /// Glossiness, 0 to 1.
    pub glossiness: f32,
}

/// Converted values of a texel, or of a material without maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// Base color, linear.
    pub base_color: Vec3,
    /// Metallic share, 0 to 1.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
}

impl Factors {
    /// The conversion of Khronos (glTF repository, KHR_materials_pbrSpecularGlossiness, "convert
    /// between workflows"): the metallic value that keeps the brightness of diffuse and specular
    /// with 4 % dielectric reflectance.
    pub fn to_metallic_roughness(self) -> MetallicRoughness {
        const DIELECTRIC: f32 = 0.04;
        const LEAST: f32 = 1e-6;
        let brightness = |c: Vec3| (c * c).dot(Vec3::new(0.299, 0.587, 0.114)).sqrt();
        let rest = 1.0 - self.specular.max_element();
        let specular = brightness(self.specular);
        let metallic = if specular < DIELECTRIC {
            0.0
        } else {
            let a = DIELECTRIC;
            let b =
                brightness(self.diffuse) * rest / (1.0 - DIELECTRIC) + specular - 2.0 * DIELECTRIC;
            let c = DIELECTRIC - specular;
            let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
            ((root - b) / (2.0 * a)).clamp(0.0, 1.0)
        };
        let plain = self.diffuse * (rest / (1.0 - DIELECTRIC) / (1.0 - metallic).max(LEAST));
        let dielectric = Vec3::splat(DIELECTRIC * (1.0 - metallic));
        let metal = (self.specular - dielectric) / metallic.max(LEAST);
        MetallicRoughness {
            base_color: plain
                .lerp(metal, metallic * metallic)
                .clamp(Vec3::ZERO, Vec3::ONE),
            metallic,
            roughness: 1.0 - self.glossiness,
        }
    }
}

/// JSON keys of the extension inside a material.
const EXTENSION: &str = "extensions/KHR_materials_pbrSpecularGlossiness";

/// Replaces the core values of `material`: exactly for gray specular factors without a map,
/// else as [`Factors::to_metallic_roughness`] says, with a warning.
pub fn convert(
    gloss: &SpecularGlossiness,
    material: &mut Material,
    textures: &mut Textures<'_>,
    index: usize,
    numbers: &mut Numbers<'_>,
) -> Result<(), Fault> {
    let place = numbers.place;
    let mut texture = |info: &Option<TextureInfo>, key: &str| match info {
        Some(info) => {
            let slot = Slot {
                material: place,
                index,
                path: &format!("{EXTENSION}/{key}"),
            };
            textures.reference(info, true, &slot, &mut numbers.notes)
        }
        None => Ok(None),
    };
    let diffuse_map = texture(&gloss.diffuse_texture, "diffuseTexture")?;
    let specular_map = texture(
        &gloss.specular_glossiness_texture,
        "specularGlossinessTexture",
    )?;
    let diffuse = numbers.clamped("diffuseFactor", gloss.diffuse_factor, [1.0; 4], 1.0)?;
    let diffuse = Vec4::from(diffuse);
    let specular = numbers.clamped("specularFactor", gloss.specular_factor, [1.0; 3], 1.0)?;
    let factors = Factors {
        diffuse: diffuse.truncate(),
        specular: specular.into(),
        glossiness: numbers.unit("glossinessFactor", gloss.glossiness_factor, 1.0)?,
    };
    let notes = &mut numbers.notes;
    material.base_color = diffuse;
    material.base_color_texture = diffuse_map;
    material.metallic_roughness_texture = None;
    material.metallic = 0.0;
    material.roughness = 1.0 - factors.glossiness;
    material.reflectivity = 0.04;
    let gray = factors.specular.min_element() == factors.specular.max_element();
    if specular_map.is_none() && gray {
        material.reflectivity = factors.specular.x;
        return Ok(());
    }
    let what = "materials use specular-glossiness with a map or a tint, which is converted to \
                metallic-roughness";
    notes.add("specular-glossiness-approximated", 1, what, place);
    if diffuse_map.is_none() && specular_map.is_none() {
        let converted = factors.to_metallic_roughness();
        material.base_color = converted.base_color.extend(diffuse.w);
        material.metallic = converted.metallic;
        return Ok(());
    }
    convert_maps(
        [diffuse_map, specular_map],
        factors,
        material,
        textures,
        index,
        place,
        notes,
    );
    Ok(())
}

/// Converts the maps: one, or two that are sampled alike; else the diffuse map is kept and the material is no
/// metal.
fn convert_maps(
    maps: [Option<TextureRef>; 2],
    factors: Factors,
    material: &mut Material,
    textures: &mut Textures<'_>,
    index: usize,
    place: &str,
    notes: &mut Notes,
) {
    let [diffuse_map, specular_map] = maps;
    let alike = |a: TextureRef, b: TextureRef| {
        TextureRef { texture: 0, ..a } == TextureRef { texture: 0, ..b }
    };
    let mut converted = |maps: [Option<TextureRef>; 2], part: Part| {
        let used = maps[1].or(maps[0])?;
        let name = "specular-glossiness maps".to_owned();
        let used_by = format!("/materials/{index}/{EXTENSION} of {place}");
        let srgb = part == Part::BaseColor;
        let convert = |[diffuse, specular]: [Option<ImageSource>; 2]| {
            ImageSource::SpecularGlossiness(Arc::new(SpecularGlossinessMaps {
                diffuse,
                specular,
                factors,
                part,
            }))
        };
        let texture = textures.converted(maps, (name, used_by), srgb, convert);
        Some(TextureRef { texture, ..used })
    };
    let both_alike = diffuse_map
        .zip(specular_map)
        .is_none_or(|(a, b)| alike(a, b));
    if both_alike {
        material.base_color_texture = converted(maps, Part::BaseColor);
        material.base_color = Vec3::ONE.extend(material.base_color.w);
        material.metallic = 1.0;
    } else {
        let what = "specular-glossiness maps are sampled in other ways than their diffuse maps; only their \
                    glossiness is used";
        notes.add("specular-glossiness-layout", 1, what, place);
    }
    material.metallic_roughness_texture = converted(
        [diffuse_map.filter(|_| both_alike), specular_map],
        Part::MetallicRoughness,
    );
    material.roughness = 1.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn converted(diffuse: f32, specular: f32, glossiness: f32) -> MetallicRoughness {
        let factors = Factors {
            diffuse: Vec3::splat(diffuse),
            specular: Vec3::splat(specular),
            glossiness,
        };
        factors.to_metallic_roughness()
    }

    #[test]
    fn the_conversion_keeps_diffuse_and_specular() {
        let plastic = converted(0.5, 0.04, 0.25);
        assert!(plastic.metallic < 1e-5 && plastic.roughness == 0.75);
        assert!((plastic.base_color.x - 0.5).abs() < 1e-5);
        let metal = converted(0.0, 0.9, 1.0);
        assert!((metal.metallic - 1.0).abs() < 1e-5 && metal.roughness == 0.0);
        assert!((metal.base_color.x - 0.9).abs() < 1e-5);
        // Between them: the reflectance at normal incidence is kept.
        for (diffuse, specular) in [(0.2, 0.3), (0.7, 0.1), (0.1, 0.6)] {
            let m = converted(diffuse, specular, 0.5);
            let f0 = 0.04 * (1.0 - m.metallic) + m.base_color.x * m.metallic;
            assert!((f0 - specular).abs() < 0.12, "{specular}: {f0}, {m:?}");
        }
    }
}
