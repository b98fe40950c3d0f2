//! Primary rays: finds the ids of each pixel by rays through the BVHs, where the options ask for it.

use crate::{
    pipeline::{
        pass::{ComputePass, Pass, PassGroup},
        shared_data::SharedData,
        sub_frame::SubFrame,
    },
    plan::has_primary_rays,
};
use reflet_gpu::Checks;

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

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let surfaces = frame.surfaces();
    frame.dispatch(pass, &surfaces);
}
