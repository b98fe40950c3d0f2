//! The cut-off of roughness: which materials reflect. `is_reflector` in `shaders/lib/shade.wgsl` decides by the same
//! numbers, rounded alike, for the surfaces of pixels and of hits.

use half::f16;
use reflet_scene::desc::{PatternedKey, ReflectionMode};
use reflet_world::{Decal, LayerTexture, Material};

/// Relative increase of the roughness cut-off for metals: their cut-off is 1 + this times the cut-off of dielectrics,
/// so that their reflections begin to fade at five times the cut-off.
pub const METAL_REACH: f32 = 5.25;

/// Uppermost part of the roughness below the cut-off, in which reflections fade into the environment.
pub const CUTOFF_FADE: f32 = 0.2;

/// Steps of a number between 0 and 1 of a clear coat in the G-buffer.
pub const COAT_STEPS: f32 = 127.0;

/// Roughness below which reflections count as sharp.
pub const SHARP_ROUGHNESS: f32 = 0.05;
/// Reflectance above which a sharp reflection is what a pixel mainly shows.
pub const MIRROR_REFLECTANCE: f32 = 0.2;

/// Roughness or metalness as the G-buffer holds it, in 16 bits.
pub fn packed(value: f32) -> f32 {
    f16::from_f32(value).to_f32()
}

/// Number between 0 and 1 of a clear coat as the G-buffer holds it, in 7 bits.
pub fn packed_coat(value: f32) -> f32 {
    (value * COAT_STEPS).round() / COAT_STEPS
}

/// Whether a material has a specular lobe that a reflection could replace.
pub fn has_specular(material: &Material) -> bool {
    // Glass reflects internally whatever its specular strength.
    let is_dimmed = material.specular == Some(0.0) && !material.passes_light();
    let dielectric = material.reflectivity > 0.0 && !is_dimmed;
    // A value that follows a pattern is 0 here only where it is 0 everywhere: this is its mean.
    dielectric || material.metallic > 0.0 || material.clearcoat.is_some()
}

/// Whether the lobe of a material without its clear coat is below the cut-off; higher for metals, which show nothing
/// else.
pub(crate) fn is_base_below(material: &Material, cutoff: f32) -> bool {
    let [roughness, _] = material.extremes(PatternedKey::Roughness);
    let [_, metallic] = material.extremes(PatternedKey::Metallic);
    packed(roughness) < cutoff * (1.0 + METAL_REACH * packed(metallic))
}

/// Whether the lobe of a material's clear coat is below the cut-off, where its texture leaves it so rough.
fn is_coat_below(material: &Material, cutoff: f32) -> bool {
    let has_map = material
        .layer_texture(LayerTexture::ClearcoatRoughness)
        .is_some();
    let [roughness, _] = material.extremes(PatternedKey::ClearcoatRoughness);
    let steps = (roughness * COAT_STEPS).round();
    material.clearcoat.is_some() && (has_map || steps < cutoff * COAT_STEPS)
}

/// Whether a material can reflect at all, so that its pixels are worth marching.
pub fn can_reflect(material: &Material, cutoff: f32) -> bool {
    has_specular(material)
        && match material.reflection {
            ReflectionMode::None => false,
            ReflectionMode::Mirror => true,
            ReflectionMode::Auto => {
                material.metallic_roughness_texture.is_some()
                    || is_base_below(material, cutoff)
                    || is_coat_below(material, cutoff)
            }
        }
}

/// Whether a material can reflect where a decal with a material of its own covers some of it.
pub fn can_reflect_under(own: &Material, decal: &Decal, over: &Material, cutoff: f32) -> bool {
    let values = |m: &Material| match m.metallic_roughness_texture {
        Some(_) => [0.0, 1.0],
        None => [
            m.extremes(PatternedKey::Roughness)[0],
            m.extremes(PatternedKey::Metallic)[1],
        ],
    };
    let [own_roughness, own_metallic] = values(own);
    let [roughness, metallic] = values(over);
    let least = match decal.changes.roughness {
        true => own_roughness.min(roughness),
        false => own_roughness,
    };
    let most = match decal.changes.metallic {
        true => own_metallic.max(metallic),
        false => own_metallic,
    };
    has_specular(own)
        && own.reflection == ReflectionMode::Auto
        && packed(least) < cutoff * (1.0 + METAL_REACH * packed(most))
}
