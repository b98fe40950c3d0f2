//! Light: view-independent radiance, stored apart from the specular of this view.

use crate::pipeline::prelude::*;

/// See `shaders/light.wgsl`.
pub const PASS: Pass = Pass {
    name: "light",
    group: PassGroup::Light,
    color: [182, 167, 38],
    reads_shared: &[ShadowMaps],
    writes_shared: &[Counters],
    overrides: |options| {
        let is_hidden = f64::from(u8::from(options.image.alpha));
        vec![("HIDES_BACKGROUND", is_hidden)]
    },
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};
