//! Pyramid: the nearest depth in ever larger cells, for the march.

use crate::pipeline::prelude::*;

use super::ssr;

/// See `shaders/pyramid.wgsl`.
pub const PASS: Pass = Pass {
    name: "pyramid",
    group: PassGroup::March,
    color: [42, 128, 52],
    reads_shared: &[DepthPyramid],
    writes_shared: &[DepthPyramid],
    needed: ssr::PASS.needed,
    overrides: |options| vec![ssr::verify(options)],
    ..Pass::DEFAULT
};
