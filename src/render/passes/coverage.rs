//! Coverage: share of each pixel that surfaces cover, for pictures with a transparent background.

use crate::{
    layout::gpu_struct::gpu_struct,
    pipeline::{
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        sub_frame::SubFrame,
    },
};

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

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let params = Params {
        sample: frame.share.sample,
    };
    frame.dispatch_with(pass, &params, &Dispatch::PerPixel);
}
