//! Filter: smooths rough reflections of pictures with few sub-frames.

use crate::pipeline::prelude::*;

/// See `shaders/filter.wgsl`; `source` and `blurred` alternate between the targets reflection and blurred.
pub const PASS: Pass = Pass {
    name: "filter",
    group: PassGroup::Reflection,
    color: [237, 151, 148],
    aliases: &[
        ("source", &[Target::Reflection, Target::Blurred]),
        ("blurred", &[Target::Blurred, Target::Reflection]),
    ],
    params: Some(Params::LAYOUT),
    needed: |plan, _| plan.features.smoothed_reflections,
    ..Pass::DEFAULT
};

/// Radius in lobe widths and number of taps of both steps; the narrow one fills the gaps between the taps of the
/// wide one.
pub const STEPS: [(f32, u32); 2] = [(1.5, 20), (0.4, 8)];

gpu_struct! {
    /// Uniforms of the filter for one step.
    pub struct Params = "Params" {
        /// Radius of the taps, in widths of the lobe.
        reach: f32,
        /// Number of taps.
        taps: u32,
        /// 1: the first step, which finds how far rays go.
        is_first: u32,
    }
}

/// Records the pass: wide, then narrow.
pub fn record(passes: &[ComputePass], frame: &mut SubFrame<'_>) {
    for (step, (pass, (reach, taps))) in passes.iter().zip(STEPS).enumerate() {
        let params = Params {
            reach: frame.options.smoothing() * reach,
            taps: frame.options.taps(taps),
            is_first: u32::from(step == 0),
        };
        frame.dispatch_with(pass, &params, Dispatch::PerPixel);
    }
}
