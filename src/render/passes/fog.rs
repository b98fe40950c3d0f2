//! Fog: light that the fog between camera and visible surfaces scatters, and its transmittance.

use crate::pipeline::{
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::Checks;

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

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    frame.dispatch(pass, &Dispatch::PerPixel);
}
