//! Pyramid: the nearest depth in ever larger cells, for the march.

use crate::pipeline::{
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    ray_list::PYRAMID_LEVELS,
    shared_data::SharedData,
    sub_frame::SubFrame,
};

use super::ssr;

/// See `shaders/pyramid.wgsl`.
pub const PASS: Pass = Pass {
    name: "pyramid",
    group: PassGroup::March,
    color: [42, 128, 52],
    reads_shared: &[SharedData::DepthPyramid],
    writes_shared: &[SharedData::DepthPyramid],
    needed: ssr::PASS.needed,
    ..Pass::DEFAULT
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    frame.dispatch(pass, &Dispatch::Tiles(1 << PYRAMID_LEVELS));
}
