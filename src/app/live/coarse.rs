//! Coarse first picture, which appears soon: surfaces and shadow maps. Reflections, glass, ray tracing and light
//! sampling are left out, since their shaders and BVHs take seconds to compile and build.

use super::{Live, reload::options_of};
use crate::{
    render::{RenderError, RenderOptions},
    scene::desc::{EnvironmentShadow, Exposure, Method, ReflectionMode, ShadowMode, Visibility},
    world::{World, pose::Moving},
};

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
    world.environment.desc.shadow = EnvironmentShadow::None;
    world
}

/// Options for the coarse picture.
pub(super) fn options(mut options: RenderOptions) -> RenderOptions {
    options.reflection.method = Method::Ssr;
    options.reflection.diffuse_bounces = 0;
    options.reflection.multiple_scattering = false;
    options.image.samples = 1;
    options.image.visibility = Visibility::Raster;
    if options.image.exposure_ev == Exposure::Auto {
        options.image.exposure_ev = Exposure::Ev(0.0); // automatic exposure needs rays
    }
    options.audit = false;
    options
}

impl Live {
    /// Whether the scene is still shown coarsely.
    pub fn is_coarse(&self) -> bool {
        self.coarse.is_some()
    }

    /// Builds the features that the coarse picture leaves out.
    ///
    /// # Errors
    /// Same errors as [`crate::render::Renderer::change`]; then the coarse picture stays.
    pub fn complete(&mut self) -> Result<(), RenderError> {
        if self.coarse.is_none() {
            return Ok(());
        }
        let options = options_of(&self.scene, self.overrides);
        (self.renderer).change(&self.gpu, &self.library, &self.world, &options)?;
        self.coarse = None;
        if self.overrides.method.is_none() {
            self.auto_method = self.renderer.method();
        }
        Ok(())
    }
}
