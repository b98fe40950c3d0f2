//! Environment: the radiance that rays find where they leave the scene, of a panorama (with the density for
//! importance sampling) or of a gradient.

mod cones;
mod cube;
mod density;
mod exr;
mod hdr;
mod octahedral;
mod pixels;
mod primaries;
mod read;
#[cfg(test)]
mod tests;

use std::{f64::consts::PI, sync::Arc};

use glam::DVec3;
use half::f16;

pub use self::{
    cones::CONE_LEVELS,
    cube::{CubeMap, of_cube},
    density::Density,
    pixels::{LAYER_UNKNOWN, PanoramaLimits},
    read::read,
};
use reflet_base::math::Bounds;
use reflet_scene::desc::{EnvironmentDesc, EnvironmentShadow, FogDesc};

/// The environment of a loaded scene.
#[derive(Clone, Debug, Default)]
pub struct Environment {
    /// Description of the environment in the scene text.
    pub desc: EnvironmentDesc,
    /// Decoded panorama file, which replaces the gradient.
    pub panorama: Option<Arc<Panorama>>,
    /// Box that fog without a falloff fills, in world space.
    pub fog_box: Bounds,
}

impl Environment {
    /// The fog, where there is any.
    pub fn fog(&self) -> Option<&FogDesc> {
        self.desc.fog.as_ref().filter(|fog| fog.density > 0.0)
    }

    /// Whether surfaces are lit by samples of the environment, not in closed form.
    pub fn is_sampled(&self) -> bool {
        self.panorama.is_some() || self.casts_rays()
    }

    /// Whether shadow rays find the geometry that blocks the environment's light.
    pub fn casts_rays(&self) -> bool {
        self.desc.shadow == EnvironmentShadow::Ray && !self.is_black()
    }

    /// Radiance straight up, at the horizon and straight down; for a panorama each is its mean radiance.
    pub fn coarse_gradient(&self) -> [DVec3; 3] {
        let desc = &self.desc;
        let scale = f64::from(desc.intensity);
        match self.panorama.as_deref() {
            Some(panorama) => [panorama.mean() * scale; 3],
            None => [desc.zenith, desc.horizon, desc.ground].map(|c| c.as_dvec3() * scale),
        }
    }

    /// Upper bound of the environment's radiance in any direction and color channel.
    pub fn brightest(&self) -> f32 {
        let desc = &self.desc;
        let colors = [desc.zenith, desc.horizon, desc.ground];
        let gradient = colors
            .map(|c| c.max_element())
            .into_iter()
            .fold(0.0, f32::max);
        let panorama = self.panorama.as_ref();
        desc.intensity * panorama.map_or(gradient, |p| p.scale * f16::MAX.to_f32())
    }

    /// Whether the environment emits no light.
    pub fn is_black(&self) -> bool {
        let desc = &self.desc;
        let colors = [desc.zenith, desc.horizon, desc.ground];
        let has_light = self.panorama.is_some() || colors.iter().any(|c| c.max_element() > 0.0);
        !has_light || desc.intensity == 0.0
    }
}

impl Panorama {
    /// Mean radiance of all directions; each row is weighted by its solid angle.
    pub fn mean(&self) -> DVec3 {
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        let rows = self.texels.chunks_exact(self.width as usize);
        for (y, row) in rows.enumerate() {
            let weight = (PI * (y as f64 + 0.5) / f64::from(self.height)).sin();
            let of = |t: &[u16; 4]| [t[0], t[1], t[2]].map(|bits| f16::from_bits(bits).to_f64());
            sum += row.iter().map(|t| DVec3::from(of(t))).sum::<DVec3>() * weight;
            weights += weight * row.len() as f64;
        }
        sum * (f64::from(self.scale) / weights.max(f64::MIN_POSITIVE))
    }
}

/// A decoded panorama.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    /// File name, for messages.
    pub name: String,
    /// Pixels across, 1 to 4096.
    pub width: u32,
    /// Pixels down, 1 to 2048.
    pub height: u32,
    /// Linear radiance divided by `scale`, as 16-bit floats, top row first; the fourth channel is 1.
    pub texels: Vec<[u16; 4]>,
    /// Factor on the texels, a power of two, with which the brightest texel fits in a 16-bit float.
    pub scale: f32,
    /// Density that importance sampling follows.
    pub density: Density,
}
