//! Specular-glossiness maps converted texel by texel.

use glam::Vec3;
use image::{Rgba, RgbaImage};

use crate::gltf::{Factors, Part, SpecularGlossinessMaps};
use reflet_base::math::{linear_from_srgb, srgb_from_linear};

/// The map of `maps.part`, as large as the larger of its sources along each axis.
pub fn convert(
    maps: &SpecularGlossinessMaps,
    diffuse: Option<RgbaImage>,
    specular: Option<RgbaImage>,
) -> RgbaImage {
    let linear: Vec<f32> = (0..=255u8)
        .map(|code| linear_from_srgb(f32::from(code) / 255.0))
        .collect();
    let sides = [&diffuse, &specular].map(|m| m.as_ref().map_or((1, 1), RgbaImage::dimensions));
    let size = [sides[0].0.max(sides[1].0), sides[0].1.max(sides[1].1)];
    let texel = |map: &Option<RgbaImage>, x: u32, y: u32| {
        let Some(map) = map else {
            return [255; 4];
        };
        let scaled =
            |at: u32, from: u32, to: u32| (u64::from(at) * u64::from(to) / u64::from(from)) as u32;
        map.get_pixel(
            scaled(x, size[0], map.width()),
            scaled(y, size[1], map.height()),
        )
        .0
    };
    let color = |[r, g, b, _]: [u8; 4]| Vec3::from_array([r, g, b].map(|c| linear[usize::from(c)]));
    let code = |value: f32| (value * 255.0).round() as u8; // saturates
    RgbaImage::from_fn(size[0], size[1], |x, y| {
        let (diffuse, specular) = (texel(&diffuse, x, y), texel(&specular, x, y));
        let converted = Factors {
            diffuse: maps.factors.diffuse * color(diffuse),
            specular: maps.factors.specular * color(specular),
            glossiness: maps.factors.glossiness * f32::from(specular[3]) / 255.0,
        }
        .to_metallic_roughness();
        Rgba(match maps.part {
            Part::BaseColor => {
                let [r, g, b] = converted
                    .base_color
                    .to_array()
                    .map(srgb_from_linear)
                    .map(code);
                [r, g, b, diffuse[3]]
            }
            Part::MetallicRoughness => [
                255,
                code(converted.roughness),
                code(converted.metallic),
                255,
            ],
        })
    })
}
