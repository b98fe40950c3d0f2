//! Coverage: share of each pixel that surfaces cover, for pictures with a transparent background.

use crate::pipeline::prelude::*;

/// See `shaders/coverage.wgsl`.
pub const PASS: Pass = Pass {
    name: "coverage",
    group: PassGroup::Picture,
    color: [122, 33, 139],
    needed: |_, options| options.image.alpha,
    params: Some(Sample::LAYOUT),
    ..Pass::DEFAULT
};
