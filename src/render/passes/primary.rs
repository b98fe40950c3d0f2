//! Primary rays: finds the ids of each pixel by rays through the BVHs, where the options ask for it.

use crate::{
    pipeline::{
        frame_pass::FramePass,
        pass::{ComputePass, Pass, PassGroup},
        pass_builder::PassBuilder,
        shared_data::SharedData,
        sub_frame::SubFrame,
    },
    plan::has_primary_rays,
};
use reflet_gpu::{Checks, GpuError};

/// See `shaders/primary.wgsl`.
pub const PASS: Pass = Pass {
    name: "primary",
    group: PassGroup::Surfaces,
    color: [14, 89, 107],
    writes_shared: &[SharedData::CulledDepth, SharedData::Counters],
    needed: |_, options| has_primary_rays(options),
    overrides: |_| vec![("OF_CAMERA", 1.0)],
    // `check_world` and `Trees::build` validated every index that tracing follows.
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// The primary pass on the device.
#[derive(Debug)]
pub struct Primary(ComputePass);

impl FramePass for Primary {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let surfaces = frame.surfaces();
        frame.dispatch(&self.0, &surfaces);
    }
}
