//! Light: view-independent radiance, stored apart from the specular of this view.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    pass_builder::PassBuilder,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::{Checks, GpuError};

/// See `shaders/light.wgsl`.
pub const PASS: Pass = Pass {
    name: "light",
    group: PassGroup::Light,
    color: [182, 167, 38],
    reads_shared: &[SharedData::ShadowMaps],
    writes_shared: &[SharedData::Counters],
    // Rays towards lights follow indices that `check_world` and `Trees::build` validated.
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// The light pass on the device.
#[derive(Debug)]
pub struct Light(ComputePass);

impl FramePass for Light {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::PerPixel);
    }
}
