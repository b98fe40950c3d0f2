//! Blur: the paper's Gaussian over the combined reflection, one direction at a time.

use crate::pipeline::prelude::*;

/// See `shaders/blur.wgsl`; `source` and `blurred` alternate between the targets reflection and blurred.
pub const PASS: Pass = Pass {
    name: "blur",
    group: PassGroup::Reflection,
    color: [163, 10, 16],
    aliases: &[
        ("source", &[Target::Reflection, Target::Blurred]),
        ("blurred", &[Target::Blurred, Target::Reflection]),
    ],
    params: Some(Params::LAYOUT),
    needed: |plan, options| plan.features.reflections && options.reflection.blur_px > 0.0,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the blur in one direction.
    pub struct Params = "Params" {
        /// Direction of the blur: (1, 0) or (0, 1).
        direction: [i32; 2],
        /// Standard deviation, pixels.
        sigma_px: f32,
    }
}

/// Records the pass: horizontal, then vertical.
pub fn record(passes: &[ComputePass], frame: &mut SubFrame<'_>) {
    let sigma_px = frame.options.reflection.blur_px;
    for (pass, direction) in passes.iter().zip([[1, 0], [0, 1]]) {
        let params = Params {
            direction,
            sigma_px,
        };
        frame.dispatch_with(pass, &params, Dispatch::PerPixel);
    }
}
