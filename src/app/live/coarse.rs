//! A first picture that is soon there: surfaces and shadow maps, without what takes seconds to compile and
//! to build, which are reflections, glass, all that is followed by rays, and samples of lights.

use super::{Live, reload::options_of};
use crate::{
    render::{RenderError, RenderOptions},
    scene::desc::{EnvironmentShadow, Exposure, Method, ReflectionMode, ShadowMode, Visibility},
    world::{World, pose::Moving},
};

/// The scene without what the first picture does not show.
pub(super) fn world(of: &World) -> World {
    let mut world = of.clone();
    // What moves may reflect in another frame.
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

/// Options for the first picture.
pub(super) fn options(mut options: RenderOptions) -> RenderOptions {
    options.reflection.method = Method::Ssr;
    options.reflection.diffuse_bounces = 0;
    options.reflection.multiple_scattering = false;
    options.image.samples = 1;
    options.image.visibility = Visibility::Raster;
    if options.image.exposure_ev == Exposure::Auto {
        options.image.exposure_ev = Exposure::Ev(0.0); // it is found by rays
    }
    options.audit = false;
    options
}

impl Live {
    /// Whether most of what the scene needs is still to be built.
    pub fn is_coarse(&self) -> bool {
        self.coarse.is_some()
    }

    /// Builds what the first picture did without.
    ///
    /// # Errors
    /// As [`crate::render::Renderer::change`]; then the coarse picture stays.
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
