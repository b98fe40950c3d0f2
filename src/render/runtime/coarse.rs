//! Coarse first picture, which appears soon: surfaces and shadow maps. Reflections, glass, ray tracing and light
//! sampling are left out, since their shaders and BVHs take seconds to compile and build.

use super::Session;
use crate::{RenderError, RenderOptions};
use reflet_scene::desc::{
    EnvironmentShadow, Exposure, Method, ReflectionMode, Samples, ShadowMode, Visibility,
};
use reflet_world::{World, pose::Moving};

/// Features that are built before the first picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InitialBuild {
    /// All features that the scene needs.
    Whole,
    /// Surfaces and shadow maps, without reflections and glass; [`Session::complete`] builds the rest.
    Coarse,
}

/// World without the features that the coarse picture leaves out.
pub(super) fn world(of: &World) -> World {
    let mut world = of.clone();
    // Animated materials may turn these features on again in another frame.
    world.moving = Moving::default();
    for material in &mut world.materials {
        material.reflection = ReflectionMode::None;
        (material.transmission, material.clearcoat) = (None, None);
        (material.blended, material.light) = (false, false);
    }
    for light in &mut world.lights {
        light.desc.shadow = match light.desc.shadow {
            ShadowMode::None => ShadowMode::None,
            _ if light.desc.kind.has_size() => ShadowMode::None,
            _ => ShadowMode::Map,
        };
    }
    // Without rays, what a light tree chooses would shine through walls.
    world.lamps.clear();
    world.environment.desc.shadow = EnvironmentShadow::None;
    world
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
