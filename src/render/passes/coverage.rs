//! Coverage: share of each pixel that surfaces cover, for pictures with a transparent background.

use crate::{
    layout::gpu_struct::gpu_struct,
    pipeline::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
    },
};
use reflet_gpu::GpuError;

/// See `shaders/coverage.wgsl`.
pub const PASS: Pass = Pass {
    name: "coverage",
    group: PassGroup::Picture,
    color: [122, 33, 139],
    needed: |_, options| options.image.alpha,
    params: Some(Params::LAYOUT),
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the coverage shader for one sub-frame.
    pub struct Params = "Params" {
        /// Index of the sub-frame.
        sample: u32,
    }
}

/// The coverage pass on the device.
#[derive(Debug)]
pub struct Coverage(ComputePass);

impl FramePass for Coverage {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let params = Params {
            sample: frame.share.sample,
        };
        frame.dispatch_with(&self.0, &params, &Dispatch::PerPixel);
    }
}
