//! Arguments: sizes the dispatch that traces the listed pixels.

use crate::{
    gpu::GpuError,
    render::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
    },
};

use super::trace;

/// See `shaders/arguments.wgsl`.
pub const PASS: Pass = Pass {
    name: "arguments",
    color: [200, 230, 170],
    needed: trace::PASS.needed,
    ..Pass::DEFAULT
};

/// The pass.
#[derive(Debug)]
pub struct Arguments(ComputePass);

impl FramePass for Arguments {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::Once);
    }
}
