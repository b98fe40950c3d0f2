//! Compose: puts the reflection in place of the mirror term and adds up the sub-frames.

use crate::render::{pass::Pass, targets::Target, types::gpu_struct};

/// See `shaders/compose.wgsl`; `color` and `previous` take turns.
pub const PASS: Pass = Pass {
    name: "compose",
    reads: &[
        Target::ViewDepth,
        Target::Surface,
        Target::BaseColor,
        Target::Emission,
        Target::Radiance,
        Target::Specular,
        Target::Reflection,
        Target::Cause,
        Target::Hit,
    ],
    writes: &[Target::ColorEven, Target::ColorOdd],
    params: Some(Params::LAYOUT),
};

/// What `color` and `previous` mean in even and odd sub-frames.
pub const ALIASES: [[(&str, Target); 2]; 2] = [
    [("color", Target::ColorEven), ("previous", Target::ColorOdd)],
    [("color", Target::ColorOdd), ("previous", Target::ColorEven)],
];

gpu_struct! {
    /// Of one sub-frame.
    pub struct Params = "Params" {
        /// 0 for the first sub-frame.
        sample: u32,
        /// Unused.
        pad0: u32,
        /// Unused.
        pad1: u32,
        /// Unused.
        pad2: u32,
    }
}
