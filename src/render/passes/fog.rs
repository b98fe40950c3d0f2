//! Fog: light that the fog between camera and visible surfaces scatters, and its transmittance.

use crate::pipeline::prelude::*;

/// See `shaders/fog.wgsl`.
pub const PASS: Pass = Pass {
    name: "fog",
    group: PassGroup::Light,
    color: [85, 9, 0],
    reads_shared: &[ShadowMaps],
    writes_shared: &[Counters],
    needed: |plan, _| plan.features.fog,
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};
