//! Fog: light that the fog between camera and visible surfaces scatters, and its transmittance.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    pass_builder::PassBuilder,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::{Checks, GpuError};

/// See `shaders/fog.wgsl`.
pub const PASS: Pass = Pass {
    name: "fog",
    group: PassGroup::Light,
    color: [85, 9, 0],
    reads_shared: &[SharedData::ShadowMaps],
    writes_shared: &[SharedData::Counters],
    needed: |plan, _| plan.features.fog,
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// The fog pass on the device.
#[derive(Debug)]
pub struct Fog(ComputePass);

impl FramePass for Fog {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::PerPixel);
    }
}
