//! Split rays: splits the listed rays into leaders, which are traced first, and followers.

use crate::pipeline::prelude::*;

/// See `shaders/methods/undersampling/split_rays.wgsl`.
pub const PASS: Pass = Pass {
    name: "split_rays",
    group: PassGroup::Reflection,
    color: [162, 0, 252],
    reads_shared: &[Counters, PixelLists, DispatchSizes],
    writes_shared: &[PixelLists, Counters],
    needed: |plan, _| plan.features.undersampled,
    overrides: |options| vec![("RATE", f64::from(options.reflection.rate))],
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};
