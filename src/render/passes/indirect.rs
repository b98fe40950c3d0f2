//! Indirect: path traced diffuse light between surfaces, at the surfaces of pixels.

use crate::pipeline::prelude::*;

/// See `shaders/indirect.wgsl`.
pub const PASS: Pass = Pass {
    name: "indirect",
    group: PassGroup::Light,
    color: [190, 120, 55],
    reads_shared: &[ShadowMaps],
    writes_shared: &[Counters],
    overrides: super::denoise_indirect::constants,
    needed: |plan, _| plan.features.indirect,
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};
