//! Arguments: computes the workgroup counts of dispatches over lists.

use crate::{
    gpu::GpuError,
    render::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
    },
};

/// See `shaders/arguments.wgsl`.
pub const PASS: Pass = Pass {
    name: "arguments",
    color: [225, 235, 205],
    needed: |plan, _| plan.features.lists,
    ..Pass::DEFAULT
};

/// The arguments pass on the device.
#[derive(Debug)]
pub struct Arguments(ComputePass);

impl FramePass for Arguments {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::Groups(1));
    }
}
