//! Denoise indirect: smooths indirect diffuse light of pictures with few sub-frames.

use crate::{pipeline::prelude::*, settings::options::SMOOTHED_OVER};

/// See `shaders/denoise_indirect.wgsl`; `source` and `denoised` alternate between the targets indirect light and blurred.
pub const PASS: Pass = Pass {
    name: "denoise_indirect",
    group: PassGroup::Light,
    color: [50, 180, 140],
    aliases: &[
        ("source", &[Target::IndirectLight, Target::Blurred]),
        ("denoised", &[Target::Blurred, Target::IndirectLight]),
    ],
    params: Some(Params::LAYOUT),
    needed: |plan, options| plan.features.indirect && options.smooths(),
    ..Pass::DEFAULT
};

/// Radius, as a share of the distance that light comes from, and number of taps of each step; each fills the gaps
/// between the taps of the previous step.
pub const STEPS: [(f32, u32); 4] = [(1.0, 24), (0.5, 16), (0.25, 12), (0.1, 8)];

/// Maximum radius of the first step, as a share of the picture's height.
const WIDEST: f32 = 0.2;

const _: () = assert!(
    (STEPS[0].0 + STEPS[1].0 + STEPS[2].0 + STEPS[3].0) * WIDEST < SMOOTHED_OVER,
    "crops lack light that is smoothed into them"
);

gpu_struct! {
    /// Uniforms of the shader for one step.
    pub struct Params = "Params" {
        /// Radius of the taps, as a share of the distance that light comes from.
        reach: f32,
        /// Maximum radius, as a share of the picture's height.
        widest: f32,
        /// Number of taps.
        taps: u32,
        /// 1 in the last step.
        is_last: u32,
    }
}

/// Records the pass: step by step.
pub fn record(passes: &[ComputePass], frame: &mut SubFrame<'_>) {
    let width = frame.options.smoothing();
    for (i, (pass, (reach, taps))) in passes.iter().zip(STEPS).enumerate() {
        let params = Params {
            reach: width * reach,
            widest: width * reach * WIDEST,
            taps: frame.options.taps(taps),
            is_last: u32::from(i + 1 == STEPS.len()),
        };
        frame.dispatch_with(pass, &params, Dispatch::PerPixel);
    }
}
