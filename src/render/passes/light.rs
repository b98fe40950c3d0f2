//! Light: view-independent radiance, stored apart from the specular of this view.

use crate::pipeline::{
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::Checks;

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

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    frame.dispatch(pass, &Dispatch::PerPixel);
}
