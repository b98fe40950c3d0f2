//! Filter: smooths rough reflections of pictures with few sub-frames.

use crate::{
    gpu::GpuError,
    render::{
        frame_pass::FramePass,
        options::RenderOptions,
        pass::{ComputePass, Dispatch, Pass},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
        targets::Target,
        types::gpu_struct,
    },
};

/// See `shaders/filter.wgsl`; `source` and `blurred` are reflection and blurred, then the reverse.
pub const PASS: Pass = Pass {
    name: "filter",
    color: [205, 130, 170],
    reads: &[
        Target::ViewDepth,
        Target::Surface,
        Target::Colors,
        Target::Details,
        Target::Cause,
        Target::Hit,
        Target::Reflection,
    ],
    writes: &[Target::Blurred],
    params: Some(Params::LAYOUT),
    needed: |plan, options| plan.reflections && plan.rough_reflections && is_enabled(options),
    ..Pass::DEFAULT
};

/// From so many sub-frames on, samples alone are smooth.
pub const ENOUGH_SAMPLES: u32 = 16;

/// Whether rough reflections are to be smoothed.
pub fn is_enabled(options: &RenderOptions) -> bool {
    options.reflection.filter && options.image.samples < ENOUGH_SAMPLES
}

/// What `source` and `blurred` mean in the wide and the narrow step.
const ALIASES: [[(&str, Target); 2]; 2] = [
    [("source", Target::Reflection), ("blurred", Target::Blurred)],
    [("source", Target::Blurred), ("blurred", Target::Reflection)],
];

/// Reach and taps of both steps; the narrow one fills what the wide one left between its taps.
const STEPS: [(f32, u32); 2] = [(1.5, 20), (0.4, 8)];

gpu_struct! {
    /// Of one step.
    pub struct Params = "Params" {
        /// Of the taps, in widths of the lobe.
        reach: f32,
        /// How many.
        taps: u32,
        /// Unused.
        pad0: u32,
        /// Unused.
        pad1: u32,
    }
}

/// The pass.
#[derive(Debug)]
pub struct Filter([ComputePass; 2]);

impl FramePass for Filter {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let step = |i: usize| builder.compute(&PASS, &ALIASES[i]);
        Ok(Self([step(0)?, step(1)?]))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        for (pass, (reach, taps)) in self.0.iter().zip(STEPS) {
            let params = Params {
                reach,
                taps,
                pad0: 0,
                pad1: 0,
            };
            frame.dispatch_with(pass, &params, &Dispatch::PerPixel);
        }
    }
}
