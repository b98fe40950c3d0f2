//! Audit: traces rays for some of the screen hits, where the options ask for the share of wrong ones.

use std::sync::atomic::{AtomicU32, Ordering};

use crate::pipeline::{
    prelude::*,
    ray_list::{AUDIT_RAYS, RAYS_PER_GROUP},
};
use reflet_scene::desc::Method;

/// See `shaders/audit.wgsl`.
pub const PASS: Pass = Pass {
    name: "audit",
    group: PassGroup::Measurement,
    color: [122, 122, 122],
    reads_shared: &[PixelLists, Counters],
    writes_shared: &[Counters],
    params: Some(Params::LAYOUT),
    needed: |plan, options| {
        plan.features.reflections && options.audit && options.reflection.method == Method::Hybrid
    },
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// Maximum distance of a right screen hit from the ray's hit, in U: a fifth of the paper's T.
pub const TOLERANCE_U: f32 = 0.005;
/// The same as a share of the ray's length; the larger of the two counts.
pub const TOLERANCE_RELATIVE: f32 = 0.01;

gpu_struct! {
    /// Uniforms of the audit shader.
    pub struct Params = "Params" {
        /// Maximum distance between screen hit and ray hit, meters.
        tolerance_m: f32,
        /// The same as a share of the ray's length; the larger of the two counts.
        tolerance: f32,
        /// Random seed: other values select other hits.
        seed: u32,
    }
}

/// The audit pass on the device.
#[derive(Debug)]
pub struct Audit {
    pass: ComputePass,
    /// Number of sub-frames recorded so far, the seed: pictures of an unchanged view check different hits.
    recorded: AtomicU32,
}

impl FramePass for Audit {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self {
            pass: builder.compute(&PASS, &[])?,
            recorded: AtomicU32::new(0),
        })
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let params = Params {
            tolerance_m: TOLERANCE_U * frame.unit_m,
            tolerance: TOLERANCE_RELATIVE,
            seed: self.recorded.fetch_add(1, Ordering::Relaxed),
        };
        let groups = Dispatch::Groups(AUDIT_RAYS.div_ceil(RAYS_PER_GROUP));
        frame.dispatch_with(&self.pass, &params, groups);
    }
}
