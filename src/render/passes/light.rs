//! Light: view-independent radiance, stored apart from the specular of this view.

use crate::pipeline::prelude::*;

/// See `shaders/light.wgsl`.
pub const PASS: Pass = Pass {
    name: "light",
    group: PassGroup::Light,
    color: [182, 167, 38],
    reads_shared: &[ShadowMaps],
    writes_shared: &[Counters],
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};
