//! Capture: the static scene, seen from every probe. It runs before the first frame, and again where its light or a
//! material has changed.

use crate::{
    frame_pass::FramePass,
    gpu_struct::gpu_struct,
    pass::{ComputePass, Pass, PassGroup},
    pass_builder::PassBuilder,
    plan::Plan,
    resources::Resources,
    shared_data::SharedData,
    shared_groups::SharedGroups,
    sub_frame::SubFrame,
};
use reflet_gpu::{Checks, GpuError};

/// See `shaders/capture.wgsl`.
pub const PASS: Pass = Pass {
    name: "capture",
    group: PassGroup::Capture,
    color: [252, 10, 251],
    params: Some(Params::LAYOUT),
    // Bound, as the code of light names them, but left unread by the overrides.
    reads_shared: &[SharedData::ShadowMaps],
    writes_shared: &[SharedData::ProbeMaps],
    needed: |plan, _| plan.features.probes,
    // Things that move are left out, and so are shadow maps, on which they may be.
    overrides: |_| {
        vec![
            ("STATIC_ONLY", 1.0),
            ("HAS_SHADOW_RAYS", 1.0),
            ("HAS_HARD_SHADOW_RAYS", 1.0),
            ("HAS_CUBE_MAPS", 0.0),
            ("HAS_FLAT_MAPS", 0.0),
        ]
    },
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the capture of one probe.
    pub struct Params = "Params" {
        /// First layer of the probe's faces.
        first_layer: u32,
        /// Width of the faces, pixels.
        face_px: u32,
        /// Number of samples per pixel.
        samples: u32,
        /// Unused.
        pad0: u32,
    }
}

/// The capture on the device.
#[derive(Debug)]
pub struct Capture {
    pass: ComputePass,
    /// Groups 0 and 1 with the blocks of the capture.
    shared: SharedGroups,
}

impl FramePass for Capture {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let maps = builder.probe_maps()?;
        let resources = Resources {
            uniforms: &maps.uniforms,
            ..builder.resources
        };
        let infos = [&builder.shader(&PASS)?.info];
        let shared = SharedGroups::new(builder.gpu, &infos, resources)?;
        let inner = PassBuilder {
            shared: &shared,
            ..*builder
        };
        let (radiance, hits) = (maps.captured_level(0), maps.hits_level());
        let view = wgpu::BindingResource::TextureView;
        let extra = [
            ("captured", view(&radiance)),
            ("captured_hits", view(&hits)),
        ];
        let pass = inner.with_resources(&PASS, "main", &extra)?;
        Ok(Self { pass, shared })
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let Some(maps) = frame.resources.probe_maps.filter(|_| frame.captures) else {
            return;
        };
        let (gpu, key) = (frame.recorder.gpu, &maps.key);
        let groups = key.face_px.div_ceil(self.pass.tile()[0]);
        let count = key.boxes.len();
        frame
            .recorder
            .pass_in_parts(PASS.name, count, |part, encoder, recording| {
                let params = Params {
                    first_layer: 6 * part as u32,
                    face_px: key.face_px,
                    samples: key.samples,
                    pad0: 0,
                };
                self.pass.set_params(gpu, &params);
                let shared = &self.shared;
                self.pass
                    .encode(encoder, recording, shared, [groups, groups, 6]);
            });
    }
}

/// Whether a frame with this plan has maps with levels for rough reflections.
pub fn has_levels(plan: &Plan) -> bool {
    plan.features.probes && plan.features.rough_reflections
}
