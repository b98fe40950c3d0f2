//! Indirect: path traced diffuse light between surfaces, at the surfaces of pixels.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    pass_builder::PassBuilder,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::{Checks, GpuError};

/// See `shaders/indirect.wgsl`.
pub const PASS: Pass = Pass {
    name: "indirect",
    group: PassGroup::Light,
    color: [190, 120, 55],
    reads_shared: &[SharedData::ShadowMaps],
    writes_shared: &[SharedData::Counters],
    overrides: super::soften::constants,
    needed: |plan, _| plan.features.indirect,
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// The indirect pass on the device.
#[derive(Debug)]
pub struct Indirect(ComputePass);

impl FramePass for Indirect {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::PerPixel);
    }
}
