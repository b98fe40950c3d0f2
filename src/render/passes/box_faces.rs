//! Box faces: captures what is static in the box of method `ssr+box`, as its faces see it. It runs before the first
//! frame.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Pass, PassGroup},
    pass_builder::PassBuilder,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::{Checks, GpuError};

/// See `shaders/box_faces.wgsl`.
pub const PASS: Pass = Pass {
    name: "box_faces",
    group: PassGroup::Capture,
    color: [0, 0, 250],
    writes_shared: &[SharedData::BoxFaces],
    needed: |plan, _| plan.features.box_faces,
    overrides: |_| vec![("STATIC_ONLY", 1.0)],
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// The capture on the device.
#[derive(Debug)]
pub struct BoxFaces(ComputePass);

impl FramePass for BoxFaces {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let extra = [("written_faces", builder.box_faces()?.written())];
        Ok(Self(builder.with_resources(&PASS, "main", &extra)?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let Some(faces) = frame.resources.box_faces.filter(|_| frame.captures) else {
            return;
        };
        let groups = faces.key.face_px.div_ceil(self.0.tile()[0]);
        frame.recorder.pass(PASS.name, |encoder, recording| {
            let shared = recording.shared;
            self.0
                .encode(encoder, recording, shared, [groups, groups, 6]);
        });
    }
}
