//! Screen-space reflections: marches the depth buffer along the mirror ray and names the cause
//! where that cannot answer; `compact.rs` lists those pixels for `trace.rs`.

use crate::{
    gpu::GpuError,
    render::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
        targets::Target,
        types::gpu_struct,
    },
    scene::desc::{Method, ReflectionDesc},
};

/// See `shaders/ssr.wgsl`.
pub const PASS: Pass = Pass {
    name: "ssr",
    color: [70, 160, 90],
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
    needed: |plan, _| plan.reflections,
    overrides: |options| {
        let marches = options.reflection.method != Method::Rt;
        vec![("MARCH", f64::from(u8::from(marches)))]
    },
    counted: true,
    ..Pass::DEFAULT
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
    fn new(settings: &ReflectionDesc, unit_m: f32) -> Self {
        Self {
            threshold_m: settings.threshold_u * unit_m,
            steps: settings.steps,
            pad0: 0,
            pad1: 0,
        }
    }
}

/// The pass.
#[derive(Debug)]
pub struct Ssr(ComputePass);

impl FramePass for Ssr {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let params = Params::new(&frame.options.reflection, frame.unit_m);
        frame.dispatch_with(&self.0, &params, &Dispatch::PerPixel);
    }
}
