//! Details: values of the visible surfaces that the G-buffer has no bits for.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Pass, PassGroup},
    pass_builder::PassBuilder,
    sub_frame::SubFrame,
};
use reflet_gpu::GpuError;

/// See `shaders/details.wgsl`.
pub const PASS: Pass = Pass {
    name: "details",
    group: PassGroup::Surfaces,
    color: [70, 78, 207],
    needed: |plan, _| plan.features.details,
    ..Pass::DEFAULT
};

/// The details pass on the device.
#[derive(Debug)]
pub struct Details(ComputePass);

impl FramePass for Details {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let surfaces = frame.surfaces();
        frame.dispatch(&self.0, &surfaces);
    }
}
