//! What rays that leave the scene see: a panorama with the density that samples of it follow, or a
//! gradient.

mod density;
mod read;

use std::sync::Arc;

pub use self::{
    density::Density,
    read::{LARGEST_KEPT, PanoramaLimits, read},
};
use crate::scene::desc::{EnvironmentDesc, EnvironmentShadow};

/// The environment of a loaded scene.
#[derive(Clone, Debug, Default)]
pub struct Environment {
    /// As it is written.
    pub desc: EnvironmentDesc,
    /// Its file, decoded; in place of the gradient.
    pub panorama: Option<Arc<Panorama>>,
}

impl Environment {
    /// Whether it lights surfaces by samples, not in closed form.
    pub fn is_sampled(&self) -> bool {
        self.panorama.is_some() || self.casts_rays()
    }

    /// Whether rays find what is in the way of its light.
    pub fn casts_rays(&self) -> bool {
        self.desc.shadow == EnvironmentShadow::Ray && !self.is_black()
    }

    fn is_black(&self) -> bool {
        let desc = &self.desc;
        let colors = [desc.zenith, desc.horizon, desc.ground];
        let has_light = self.panorama.is_some() || colors.iter().any(|c| c.max_element() > 0.0);
        !has_light || desc.intensity == 0.0
    }
}

/// A decoded panorama.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    /// Its file, for messages.
    pub name: String,
    /// Pixels across, 1 to 4096.
    pub width: u32,
    /// Pixels down, 1 to 2048.
    pub height: u32,
    /// Whether the file has more pixels.
    pub is_reduced: bool,
    /// Linear radiance over `scale`, 16-bit floats, top row first; the fourth is 1.
    pub texels: Vec<[u16; 4]>,
    /// A power of two, with which the brightest texel fits.
    pub scale: f32,
    /// What samples of it follow.
    pub density: Density,
}
