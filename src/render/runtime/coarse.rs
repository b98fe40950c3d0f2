//! Coarse first picture, which appears soon: surfaces and shadow maps. Reflections, glass, ray tracing and light
//! sampling are left out, since their shaders and BVHs take seconds to compile and build.

use super::Session;
use crate::{RenderError, RenderOptions, decide::map_work::doubtful_maps};
use reflet_scene::desc::{
    EnvironmentShadow, Exposure, Method, ReflectionMode, Samples, ShadowMode, Visibility,
};
use reflet_world::{Light, MAX_LIGHTS, World, light_tree::power_of_lamp, pose::Moving};

/// Features that are built before the first picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InitialBuild {
    /// All features that the scene needs.
    Whole,
    /// Surfaces and shadow maps, without reflections and glass; [`Session::complete`] builds the rest.
    Coarse,
}

/// World without the features that the coarse picture leaves out.
pub(super) fn world(of: &World, options: &RenderOptions) -> World {
    let mut world = of.clone();
    let doubtful = doubtful_maps(of, options);
    // Animated materials may turn these features on again in another frame.
    world.moving = Moving::default();
    for material in &mut world.materials {
        material.reflection = ReflectionMode::None;
        (material.transmission, material.clearcoat) = (None, None);
        (material.blended, material.light) = (false, false);
    }
    for (index, light) in world.lights.iter_mut().enumerate() {
        light.desc.shadow = match light.desc.shadow {
            ShadowMode::None => ShadowMode::None,
            _ if light.desc.kind.has_size() => ShadowMode::None,
            _ if doubtful >> index & 1 != 0 => ShadowMode::None,
            _ => ShadowMode::Map,
        };
    }
    let room = MAX_LIGHTS.saturating_sub(world.lights.len());
    let lamps = std::mem::take(&mut world.lamps);
    world.lights.extend(stand_ins(&lamps, room));
    if !lamps.is_empty() {
        (world.light_order, world.file_lights) = (Vec::new(), Vec::new());
    }
    // Lights that are left out are dark already, and their indices follow an order that is gone.
    world.left_out = Default::default();
    world.environment.desc.shadow = EnvironmentShadow::None;
    world
}

/// At most `most` lamps in place of all lamps of a light tree, with their power together, as points and cones without
/// shadow. Each stands for the same share of the power (systematic sampling).
fn stand_ins(lamps: &[Light], most: usize) -> Vec<Light> {
    let powers = lamps.iter().map(power_of_lamp);
    let share = powers.clone().sum::<f64>() / most as f64;
    let (mut sum, mut taken) = (0.0, 0.0);
    let mut found = Vec::new();
    for (lamp, power) in lamps.iter().zip(powers) {
        sum += power;
        // The next stand-in is the lamp around half a share past the taken power.
        let times = ((sum / share + 0.5).floor() - taken).max(0.0);
        if times < 1.0 || found.len() == most {
            continue;
        }
        taken += times;
        let mut light = lamp.clone();
        light.desc.color *= (times * share / power) as f32;
        light.desc.shadow = ShadowMode::None;
        light.desc.kind = lamp.desc.kind.without_size();
        found.push(light);
    }
    found
}

/// Options for the coarse picture.
pub(super) fn options(mut options: RenderOptions) -> RenderOptions {
    options.reflection.method = Method::Ssr;
    options.reflection.diffuse_bounces = 0;
    options.reflection.multiple_scattering = false;
    options.image.samples = Samples::Count(1);
    options.image.visibility = Visibility::Raster;
    if options.image.exposure_ev == Exposure::Auto {
        options.image.exposure_ev = Exposure::Ev(0.0); // automatic exposure needs rays
    }
    options.audit = false;
    options.guides = false;
    options
}

impl Session {
    /// Whether the scene is still shown coarsely.
    pub fn is_coarse(&self) -> bool {
        self.coarse.is_some()
    }

    /// Builds the features that the coarse picture leaves out.
    ///
    /// # Errors
    /// Same errors as [`crate::Renderer::change`]; then the coarse picture stays.
    pub fn complete(&mut self) -> Result<(), RenderError> {
        match self.coarse {
            Some(_) => self.refresh().map(drop),
            None => Ok(()),
        }
    }
}
