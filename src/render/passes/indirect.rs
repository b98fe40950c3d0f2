//! Indirect: path traced diffuse light between surfaces, at the surfaces of pixels.

use crate::pipeline::{
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::Checks;

/// See `shaders/indirect.wgsl`.
pub const PASS: Pass = Pass {
    name: "indirect",
    group: PassGroup::Light,
    color: [190, 120, 55],
    reads_shared: &[SharedData::ShadowMaps],
    writes_shared: &[SharedData::Counters],
    overrides: super::denoise_indirect::constants,
    needed: |plan, _| plan.features.indirect,
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    frame.dispatch(pass, &Dispatch::PerPixel);
}
