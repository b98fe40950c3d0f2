//! Screen-space reflections: marches the depth buffer along the mirror ray and names the cause
//! where that cannot answer; `compact.rs` lists those pixels for `trace.rs`.

use crate::{
    render::{pass::Pass, targets::Target, types::gpu_struct},
    scene::desc::ReflectionDesc,
};

/// See `shaders/ssr.wgsl`.
pub const PASS: Pass = Pass {
    name: "ssr",
    reads: &[
        Target::Ids,
        Target::ViewDepth,
        Target::Surface,
        Target::BaseColor,
        Target::Emission,
        Target::Radiance,
    ],
    writes: &[Target::Reflection, Target::Cause, Target::Hit],
    params: Some(Params::LAYOUT),
};

gpu_struct! {
    /// Of the march.
    pub struct Params = "Params" {
        /// The paper's T, meters.
        threshold_m: f32,
        /// Most steps.
        steps: u32,
        /// Unused.
        pad0: u32,
        /// Unused.
        pad1: u32,
    }
}

impl Params {
    /// Of the scene's settings with its unit.
    pub fn new(settings: &ReflectionDesc, unit_m: f32) -> Self {
        Self {
            threshold_m: settings.threshold_u * unit_m,
            steps: settings.steps,
            pad0: 0,
            pad1: 0,
        }
    }
}
