//! Blur: the paper's Gaussian over the combined reflection, one direction at a time.

use crate::{
    layout::gpu_struct::gpu_struct,
    pipeline::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
        targets::Target,
    },
};
use reflet_gpu::GpuError;

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

/// The blur pass on the device, horizontal and vertical.
#[derive(Debug)]
pub struct Blur([ComputePass; 2]);

impl FramePass for Blur {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let direction = |i: usize| builder.compute(&PASS, &PASS.swapped(i));
        Ok(Self([direction(0)?, direction(1)?]))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let sigma_px = frame.options.reflection.blur_px;
        for (pass, direction) in self.0.iter().zip([[1, 0], [0, 1]]) {
            let params = Params {
                direction,
                sigma_px,
            };
            frame.dispatch_with(pass, &params, &Dispatch::PerPixel);
        }
    }
}
