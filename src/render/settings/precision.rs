//! Precision of a picture's stored light.

use serde::Serialize;

use reflet_scene::desc::{Exposure, PatternedKey, Radiance};
use reflet_world::World;

use super::options::RenderOptions;

/// Maximum radiance for 16-bit storage, whose range ends at 65,504: surfaces that it lights need the room above.
const BRIGHTEST: f32 = 16_384.0;
/// Exposure, stops, above which 16-bit values near 0 are too coarse for the steps of the display.
const DARKEST_EV: f32 = 5.0;

/// Precision of the light that a frame stores between its passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Precision {
    /// Whether channels have 32 bits rather than 16.
    pub full: bool,
    /// Number of stops by which emission is darkened for storage in 16 bits.
    pub emission_stops: u32,
}

impl Precision {
    /// Precision that a scene needs, or that its text sets.
    pub fn for_world(world: &World, options: &RenderOptions) -> Self {
        let emitted = brightest_emission(world);
        let needs_full = || {
            let brightest = emitted.max(brightest_light(world));
            let darkest = match options.image.exposure_ev {
                Exposure::Ev(ev) => ev,
                // Automatic exposure shows the brightest value as white, or brighter.
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

    /// Emission of surfaces, over its stored value: a power of two.
    pub fn emission_scale(self) -> f32 {
        (self.emission_stops as f32).exp2()
    }
}

/// Maximum radiance that surfaces emit.
pub fn brightest_emission(world: &World) -> f32 {
    let brightest = |materials: &mut dyn Iterator<Item = usize>| {
        materials
            .map(|m| &world.materials[m])
            .map(|m| m.extremes(PatternedKey::Emission)[1])
            .fold(0.0, f32::max)
    };
    // Decals add to the emission of the surfaces under them.
    brightest(&mut world.instances.iter().map(|i| i.material))
        + brightest(&mut world.decals.list.iter().map(|d| d.material))
}

/// Maximum radiance of the environment, and of white surfaces lit by a light, at 1 m if the light has a position. A
/// glint may be brighter, and is clamped.
fn brightest_light(world: &World) -> f32 {
    let lights = world.all_lights().map(|light| {
        light.desc.kind.intensity() * light.desc.color.max_element() / std::f32::consts::PI
    });
    lights.fold(world.environment.brightest(), f32::max)
}
