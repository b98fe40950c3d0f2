//! Pyramid: the nearest depth in ever larger cells, for the march.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    pass_builder::PassBuilder,
    ray_list::PYRAMID_LEVELS,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::GpuError;

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

/// The pyramid pass on the device.
#[derive(Debug)]
pub struct Pyramid(ComputePass);

impl FramePass for Pyramid {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::Tiles(1 << PYRAMID_LEVELS));
    }
}
