//! Compact: counts causes and lists the pixels to trace.

use crate::{
    gpu::GpuError,
    render::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
        targets::Target,
    },
};

use super::trace;

/// See `shaders/compact.wgsl`.
pub const PASS: Pass = Pass {
    name: "compact",
    color: [150, 215, 130],
    reads: &[Target::Cause],
    needed: |plan, _| plan.reflections,
    overrides: |options| vec![("TRACE", f64::from(u8::from(trace::is_enabled(options))))],
    ..Pass::DEFAULT
};

/// The pass.
#[derive(Debug)]
pub struct Compact(ComputePass);

impl FramePass for Compact {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::PerPixel);
    }
}
