//! How many bits hold the light of a picture.

use serde::Serialize;

use crate::{
    scene::desc::{Exposure, Radiance},
    world::World,
};

use super::options::RenderOptions;

/// Brightest thing that 16 bits hold with room for what it lights beside it; they end at 65,504.
const BRIGHTEST: f32 = 16_384.0;
/// Exposure from which on a step of the display is no longer many steps of 16 bits near 0, stops.
const DARKEST_EV: f32 = 5.0;

/// What keeps the light of a frame between its passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Precision {
    /// 32 bits a channel in place of 16.
    pub full: bool,
    /// By how many stops what surfaces emit is darkened where 16 bits keep it.
    pub emission_stops: u32,
}

impl Precision {
    /// What a scene needs, or its text asks for.
    pub fn of(world: &World, options: &RenderOptions) -> Self {
        let emitted = brightest_emission(world);
        let needs_full = || {
            let brightest = emitted.max(brightest_light(world));
            let darkest = match options.image.exposure_ev {
                Exposure::Ev(ev) => ev,
                // It will show the brightest as white, or brighter.
                Exposure::Auto => -brightest.max(f32::MIN_POSITIVE).log2(),
            };
            brightest > BRIGHTEST || darkest > DARKEST_EV
        };
        let stops = (emitted / BRIGHTEST).max(1.0).log2().ceil();
        Self {
            full: match options.image.radiance {
                _ if options.is_unbiased() => true,
                Radiance::Half => false,
                Radiance::Full => true,
                Radiance::Auto => needs_full(),
            },
            emission_stops: stops as u32,
        }
    }

    /// What surfaces emit, over what is kept of it: a power of two.
    pub fn emission_scale(self) -> f32 {
        (self.emission_stops as f32).exp2()
    }
}

/// Radiance that surfaces emit, at most.
pub fn brightest_emission(world: &World) -> f32 {
    let materials = world.instances.iter().map(|i| &world.materials[i.material]);
    materials
        .map(|m| m.emission.max_element())
        .fold(0.0, f32::max)
}

/// Radiance of the environment, and of white that a light reaches, from 1 m where it stands somewhere;
/// the brighter. A glint may be brighter, and is cut.
fn brightest_light(world: &World) -> f32 {
    let lights = world.lights.iter().map(|light| {
        light.desc.kind.intensity() * light.desc.color.max_element() / std::f32::consts::PI
    });
    lights.fold(world.environment.brightest(), f32::max)
}
