//! Arguments: computes the workgroup counts of dispatches over lists.

use crate::pipeline::prelude::*;

/// See `shaders/arguments.wgsl`.
pub const PASS: Pass = Pass {
    name: "arguments",
    group: PassGroup::Reflection,
    color: [178, 57, 122],
    needed: |plan, _| plan.features.lists,
    reads_shared: &[Counters],
    writes_shared: &[DispatchSizes],
    ..Pass::DEFAULT
};
