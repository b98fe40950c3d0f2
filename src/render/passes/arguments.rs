//! Arguments: computes the workgroup counts of dispatches over lists.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    pass_builder::PassBuilder,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::GpuError;

/// See `shaders/arguments.wgsl`.
pub const PASS: Pass = Pass {
    name: "arguments",
    group: PassGroup::Reflection,
    color: [178, 57, 122],
    needed: |plan, _| plan.features.lists,
    reads_shared: &[SharedData::Counters],
    writes_shared: &[SharedData::DispatchSizes],
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
