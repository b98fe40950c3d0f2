//! Paths: the shared declaration of the passes that follow paths from the surfaces of pixels on, each for one kind of light.

pub use crate::layout::types::{LIGHT_BEHIND, MIRRORED_LIGHT, RECEIVED_LIGHT};
use crate::{
    pipeline::{pass::Override, prelude::*},
    settings::options::RenderOptions,
};

use super::ssr;

/// Declaration of a pass of `shaders/paths.wgsl`, but for its name and its light.
pub const SHARED: Pass = Pass {
    shader: "paths",
    reads_shared: &[Counters, ShadowMaps, PixelLists, DispatchSizes],
    writes_shared: &[Counters],
    params: Some(Params::LAYOUT),
    overrides,
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of a pass that follows paths.
    pub struct Params = "Params" {
        /// Kind of the light that is found: [`MIRRORED_LIGHT`], [`LIGHT_BEHIND`] or [`RECEIVED_LIGHT`].
        light: u32,
        /// 1: the leaders among the mirror rays are followed alone, before the other rays; else 0.
        leads: u32,
    }
}

impl Params {
    /// Uniforms of a pass that finds this kind of light, by all listed rays.
    pub fn new(light: u32) -> Self {
        Self { light, leads: 0 }
    }
}

/// Constants, which are the same for all passes, so that these share a pipeline; but where mirror rays march through maps,
/// other paths have a pipeline of their own.
fn overrides(options: &RenderOptions) -> Vec<Override> {
    let is_apart = options.reflection.method.maps().is_some();
    constants(options, !is_apart)
}

/// Constants of a pipeline that follows mirror rays where the method has some.
pub fn mirror_overrides(options: &RenderOptions) -> Vec<Override> {
    constants(options, true)
}

fn constants(options: &RenderOptions, mirrors: bool) -> Vec<Override> {
    let (marches, traces) = (ssr::is_enabled(options), options.reflection.method.traces());
    let flags = [
        ("TRACE", traces),
        ("MIRRORS", mirrors && (marches || traces)),
        ("SMOOTHED", options.smooths()),
    ];
    flags
        .map(|(name, on)| (name, f64::from(u8::from(on))))
        .to_vec()
}
