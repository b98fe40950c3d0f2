//! Screen-space reflections: marches the listed pixels' rays through the depth pyramid; lists screen hits for
//! `hits.rs`, and rays that the screen cannot answer for `trace.rs`.

use crate::{pipeline::prelude::*, settings::options::RenderOptions};
use reflet_scene::desc::{Method, ReflectionDesc};

/// See `shaders/ssr.wgsl`.
pub const PASS: Pass = Pass {
    name: "ssr",
    group: PassGroup::March,
    color: [100, 229, 167],
    reads_shared: &[Counters, PixelLists, DispatchSizes, DepthPyramid],
    writes_shared: &[PixelLists, Counters],
    params: Some(Params::LAYOUT),
    needed: |plan, options| plan.features.reflections && is_enabled(options),
    overrides: |options| {
        let traces = options.reflection.method != Method::Ssr;
        vec![verify(options), ("TRACE", f64::from(u8::from(traces)))]
    },
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// Whether the method marches.
pub fn is_enabled(options: &RenderOptions) -> bool {
    options.reflection.method.marches()
}

/// Override that says whether the march verifies its hits.
pub fn verify(options: &RenderOptions) -> (&'static str, f64) {
    let verifies = options.reflection.verifies();
    ("VERIFY", f64::from(u8::from(verifies)))
}

gpu_struct! {
    /// Uniforms of the march.
    pub struct Params = "Params" {
        /// The paper's depth threshold T, meters.
        threshold_m: f32,
        /// Maximum number of steps.
        steps: u32,
        /// Maximum distance of a verified hit from the pixel that shows it, pixels.
        edge_px: f32,
        /// Minimum distance of the second depth layer from the first, meters.
        separation_m: f32,
    }
}

impl Params {
    /// Uniforms for the scene's settings and its unit length.
    fn new(settings: &ReflectionDesc, unit_m: f32) -> Self {
        Self {
            threshold_m: settings.threshold_u * unit_m,
            steps: settings.steps,
            edge_px: settings.edge_px,
            separation_m: settings.separation_in(unit_m),
        }
    }
}

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let params = Params::new(&frame.options.reflection, frame.unit_m);
    let reflectors = Dispatch::Listed(List::Reflectors);
    frame.dispatch_with(pass, &params, reflectors);
}
