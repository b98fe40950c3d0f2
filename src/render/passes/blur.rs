//! Blur: the paper's Gaussian over the combined reflection, one direction at a time.

use crate::render::{pass::Pass, targets::Target, types::gpu_struct};

/// See `shaders/blur.wgsl`; `source` and `blurred` are reflection and blurred, then the reverse.
pub const PASS: Pass = Pass {
    name: "blur",
    reads: &[
        Target::ViewDepth,
        Target::Surface,
        Target::Cause,
        Target::Reflection,
    ],
    writes: &[Target::Blurred],
    params: Some(Params::LAYOUT),
};

/// What `source` and `blurred` mean across, then down.
pub const ALIASES: [[(&str, Target); 2]; 2] = [
    [("source", Target::Reflection), ("blurred", Target::Blurred)],
    [("source", Target::Blurred), ("blurred", Target::Reflection)],
];

gpu_struct! {
    /// Of one direction.
    pub struct Params = "Params" {
        /// (1, 0) or (0, 1).
        direction: [i32; 2],
        /// Standard deviation, pixels.
        sigma_px: f32,
        /// Unused.
        pad: u32,
    }
}
