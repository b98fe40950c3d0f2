//! Channels of a frame that viewers can display, and the legends of their colors.

use std::iter;

use reflet_base::math::LUMINANCE;
use reflet_render::{Plane, PlaneData, picture::aov::Aov};

/// Brightness of pixels without a traced ray, as a fraction.
const DIMMED: f32 = 0.3;
/// Value of the first ray in the color map.
const FIRST_RAY_VALUE: f32 = 0.35;
/// Colors of the map magma at 0, 1/4, 1/2, 3/4 and 1.
const MAGMA: [[u8; 3]; 5] = [
    [0, 0, 4],
    [81, 18, 124],
    [183, 55, 121],
    [252, 137, 97],
    [252, 253, 191],
];

/// Face positions in an unfolded cube map, in faces from the top left; neighbors share an edge.
pub const CUBE_CROSS: [[u32; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]];
/// Gray around a picture of another aspect ratio, 0 to 255.
pub const BACKGROUND_GRAY: u8 = 16;

/// Displayed channel of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewChannel {
    /// The finished picture.
    Picture,
    /// An AOV.
    Aov(Aov),
    /// The shadow map of a light.
    Shadow(ShadowMapChoice),
    /// Traced pixels, colored by their index in the ray list.
    Rays,
}

/// One light's shadow map, or a face of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowMapChoice {
    /// Index into the world's lights.
    pub light: usize,
    /// Face of a point light's cube; `None` unfolds all six.
    pub face: Option<usize>,
}

impl ViewChannel {
    /// Channels that every frame has: all but shadow maps.
    pub fn of_frames() -> impl Iterator<Item = Self> {
        let aovs = Aov::ALL.into_iter().map(Self::Aov);
        iter::once(Self::Picture).chain(aovs).chain([Self::Rays])
    }

    /// Name in menus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Aov(aov) => aov.name(),
            Self::Shadow(_) => "shadow_map",
            Self::Rays => "ray_list",
        }
    }

    /// Whether its pixels correspond to the camera's, so that a click can pick an instance.
    pub fn is_of_camera(self) -> bool {
        !matches!(self, Self::Shadow(_))
    }

    /// Whether it is an unfolded cube map.
    pub fn is_cross(self, shadow_lights: &[ShadowLight]) -> bool {
        let Self::Shadow(ShadowMapChoice { light, face: None }) = self else {
            return false;
        };
        let mut of = shadow_lights
            .iter()
            .filter(|shadow_light| shadow_light.light == light);
        of.any(|shadow_light| shadow_light.faces > 1)
    }

    /// Equivalent channel in a reloaded scene, by the light's name; the picture if it has no map now.
    pub fn after_reload(self, old: &[ShadowLight], new: &[ShadowLight]) -> Self {
        let Self::Shadow(shadow_map) = self else {
            return self;
        };
        let light = old.iter().find(|old| old.light == shadow_map.light);
        let found = light.and_then(|old| new.iter().find(|new| new.name == old.name));
        found.map_or(Self::Picture, |new| Self::Shadow(new.map(shadow_map.face)))
    }
}

/// A light with shadow maps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowLight {
    /// Index into the world's lights.
    pub light: usize,
    /// Name of the light.
    pub name: String,
    /// Number of maps: six for a point light.
    pub faces: usize,
}

impl ShadowLight {
    /// Shadow map of this face, if the light has it; else its whole map.
    pub fn map(&self, face: Option<usize>) -> ShadowMapChoice {
        ShadowMapChoice {
            light: self.light,
            face: face.filter(|face| *face < self.faces),
        }
    }
}

/// Legend of an AOV.
pub fn aov_legend(aov: Aov, plane: &Plane) -> String {
    let text = match (aov, &plane.data) {
        (Aov::Depth | Aov::HitDistance, PlaneData::F32(distances)) => {
            return distance_legend(distances, "black");
        }
        (Aov::Normal, _) => "red, green, blue: x, y, z from -1 to 1",
        (Aov::Material, _) => "red: roughness, green: metallic, blue: reflectivity",
        (Aov::Reflectance, _) => "black: 0, white: 1",
        (Aov::Source | Aov::Cause, _) => "colors as in the panel's Reflections",
        (Aov::Ids | Aov::HitIds, _) => "a color for each instance and triangle",
        _ => "linear radiance, clipped at 1",
    };
    text.to_owned()
}

/// Legend of a gray scale of distances: its ends, and the color of nothing.
pub fn distance_legend(distances: &[f32], nothing: &str) -> String {
    let finite = distances.iter().filter(|distance| distance.is_finite());
    let (least, most) = finite.fold((f32::INFINITY, 0.0_f32), |(least, most), distance| {
        (least.min(*distance), most.max(*distance))
    });
    if least > most {
        return "no surface".to_owned();
    }
    format!("white: {least:.2} m, black: {most:.2} m; no surface: {nothing}")
}

/// The picture, dim and gray, with the traced pixels colored by their index in the list, and its legend.
pub fn ray_order(size: [u32; 2], rays: Option<Vec<[u32; 2]>>, display: &[u8]) -> (Vec<u8>, String) {
    let legend = match &rays {
        Some(rays) => format!(
            "{} rays start from {:.1} % of the pixels; dark: first in the list, light: last",
            rays.len(),
            100.0 * rays.len() as f64 / (f64::from(size[0]) * f64::from(size[1])),
        ),
        None => "no ray list: this method traces nothing, or nothing reflects".to_owned(),
    };
    let dim = |texel: &[u8]| {
        let rgb = [0, 1, 2].map(|i| f32::from(texel[i]));
        let gray = (DIMMED * LUMINANCE.dot(rgb.into())) as u8;
        [gray, gray, gray, 255]
    };
    let mut rgba: Vec<u8> = display.chunks_exact(4).flat_map(dim).collect();
    let rays = rays.unwrap_or_default();
    let last = rays.len().saturating_sub(1).max(1) as f32;
    for (index, [x, y]) in rays.iter().enumerate() {
        let color = magma(FIRST_RAY_VALUE + (1.0 - FIRST_RAY_VALUE) * index as f32 / last);
        let at = 4 * (y * size[0] + x) as usize;
        if let Some(texel) = rgba.get_mut(at..at + 3) {
            texel.copy_from_slice(&color);
        }
    }
    (rgba, legend)
}

/// Color of a value from 0 to 1, between the nearest two of [`MAGMA`].
fn magma(value: f32) -> [u8; 3] {
    let at = value.clamp(0.0, 1.0) * (MAGMA.len() - 1) as f32;
    let below = (at as usize).min(MAGMA.len() - 2);
    let between = |lane| {
        let [low, high] = [MAGMA[below], MAGMA[below + 1]].map(|color| f32::from(color[lane]));
        (low + (high - low) * (at - below as f32)).round() as u8
    };
    [0, 1, 2].map(between)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shadow_light(light: usize, name: &str, faces: usize) -> ShadowLight {
        ShadowLight {
            light,
            name: name.to_owned(),
            faces,
        }
    }

    fn shadow(light: usize, face: Option<usize>) -> ViewChannel {
        ViewChannel::Shadow(ShadowMapChoice { light, face })
    }

    #[test]
    fn a_shadow_map_is_kept_by_the_name_of_its_light() {
        let old = [shadow_light(0, "sun", 1), shadow_light(1, "lamp", 6)];
        let new = [shadow_light(0, "lamp", 6), shadow_light(1, "moon", 1)];
        assert_eq!(
            shadow(1, Some(4)).after_reload(&old, &new),
            shadow(0, Some(4))
        );
        assert_eq!(
            shadow(0, None).after_reload(&old, &new),
            ViewChannel::Picture
        );
        let spot = [shadow_light(3, "lamp", 1)];
        assert_eq!(
            shadow(1, Some(4)).after_reload(&old, &spot),
            shadow(3, None)
        );
        assert_eq!(
            ViewChannel::Rays.after_reload(&old, &new),
            ViewChannel::Rays
        );
        assert!(shadow(1, None).is_cross(&old) && !shadow(1, None).is_cross(&new));
        assert!(!shadow(1, Some(0)).is_cross(&old));
    }

    #[test]
    fn ray_order_image_shades_pixels_by_list_position() {
        let display = vec![200; 4 * 12];
        let (rgba, _) = ray_order([4, 3], Some(vec![[3, 1], [0, 2], [1, 0]]), &display);
        let sum = |x: usize, y: usize| -> u32 {
            let at = 4 * (4 * y + x);
            rgba[at..at + 3].iter().map(|v| u32::from(*v)).sum()
        };
        assert_eq!(sum(0, 0), 3 * 60, "the picture, dimmed");
        assert!(sum(3, 1) < sum(0, 2) && sum(0, 2) < sum(1, 0));
        assert!(rgba.iter().skip(3).step_by(4).all(|alpha| *alpha == 255));
    }

    #[test]
    fn distance_legend_states_both_ends() {
        let text = distance_legend(&[f32::INFINITY, 2.5, 1.25], "blue");
        assert_eq!(text, "white: 1.25 m, black: 2.50 m; no surface: blue");
        assert_eq!(distance_legend(&[f32::INFINITY], "blue"), "no surface");
    }
}
