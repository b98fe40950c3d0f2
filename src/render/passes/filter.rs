//! Filter: smooths rough reflections of pictures with few sub-frames.

use crate::{
    layout::gpu_struct::gpu_struct,
    pipeline::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
        targets::Target,
    },
    settings::options::RenderOptions,
};
use reflet_gpu::GpuError;

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
    needed: |plan, options| {
        plan.features.reflections && plan.features.rough_reflections && is_enabled(options)
    },
    ..Pass::DEFAULT
};

/// Whether the options ask for smoothing of rough reflections.
pub fn is_enabled(options: &RenderOptions) -> bool {
    options.smooths()
}

/// Radius in lobe widths and number of taps of both steps; the narrow one fills the gaps between the taps of the
/// wide one.
const STEPS: [(f32, u32); 2] = [(1.5, 20), (0.4, 8)];

gpu_struct! {
    /// Uniforms of the filter for one step.
    pub struct Params = "Params" {
        /// Radius of the taps, in widths of the lobe.
        reach: f32,
        /// Number of taps.
        taps: u32,
    }
}

/// The filter pass on the device, wide and narrow step.
#[derive(Debug)]
pub struct Filter([ComputePass; 2]);

impl FramePass for Filter {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let step = |i: usize| builder.compute(&PASS, &PASS.swapped(i));
        Ok(Self([step(0)?, step(1)?]))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        for (pass, (reach, taps)) in self.0.iter().zip(STEPS) {
            let params = Params { reach, taps };
            frame.dispatch_with(pass, &params, &Dispatch::PerPixel);
        }
    }
}
