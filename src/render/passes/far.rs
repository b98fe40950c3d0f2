//! Far: captures what the camera sees behind the box of method `near-far`, in all directions. It runs before every
//! sub-frame for which the camera or the scene has moved.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Pass, PassGroup},
    pass_builder::PassBuilder,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::{Checks, GpuError};

/// See `shaders/far.wgsl`.
pub const PASS: Pass = Pass {
    name: "far",
    group: PassGroup::Capture,
    color: [0, 0, 0],
    writes_shared: &[SharedData::FarMaps],
    needed: |plan, _| plan.features.near_far,
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// The capture on the device.
#[derive(Debug)]
pub struct Far(ComputePass);

impl FramePass for Far {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let extra = [("far_hits", builder.far_maps()?.written())];
        Ok(Self(builder.with_resources(&PASS, "main", &extra)?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let Some(maps) = frame.resources.far_maps.filter(|_| frame.captures) else {
            return;
        };
        let groups = maps.key.face_px.div_ceil(self.0.tile()[0]);
        frame.recorder.pass(PASS.name, |encoder, recording| {
            let shared = recording.shared;
            self.0
                .encode(encoder, recording, shared, [groups, groups, 6]);
        });
    }
}
