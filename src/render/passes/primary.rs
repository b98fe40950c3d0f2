//! Primary rays: finds the ids of each pixel by rays through the BVHs, where the options ask for it.

use crate::{pipeline::prelude::*, plan::has_primary_rays};

/// See `shaders/primary.wgsl`.
pub const PASS: Pass = Pass {
    name: "primary",
    group: PassGroup::Surfaces,
    color: [14, 89, 107],
    writes_shared: &[CulledDepth, Counters],
    needed: |_, options| has_primary_rays(options),
    overrides: |_| vec![("OF_CAMERA", 1.0)],
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};
