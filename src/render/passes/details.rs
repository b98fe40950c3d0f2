//! Details: values of the visible surfaces that the G-buffer has no bits for.

use crate::pipeline::prelude::*;

/// See `shaders/details.wgsl`.
pub const PASS: Pass = Pass {
    name: "details",
    group: PassGroup::Surfaces,
    color: [70, 78, 207],
    needed: |plan, _| plan.features.details,
    ..Pass::DEFAULT
};
