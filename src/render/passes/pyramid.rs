//! Pyramid: the nearest depth in ever larger cells, for the march.

use crate::{
    gpu::GpuError,
    render::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass},
        pass_builder::PassBuilder,
        ray_list::PYRAMID_LEVELS,
        sub_frame::SubFrame,
        targets::Target,
    },
};

use super::ssr;

/// See `shaders/pyramid.wgsl`.
pub const PASS: Pass = Pass {
    name: "pyramid",
    color: [200, 230, 170],
    reads: &[Target::ViewDepth],
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
