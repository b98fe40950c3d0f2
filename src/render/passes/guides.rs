//! Guides: color and normal of the surfaces that pixels show, means over the sub-frames, for a denoiser.

use crate::{
    layout::gpu_struct::gpu_struct,
    pipeline::{
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        sub_frame::SubFrame,
    },
};
use reflet_gpu::Checks;

/// See `shaders/guides.wgsl`.
pub const PASS: Pass = Pass {
    name: "guides",
    group: PassGroup::Picture,
    color: [0, 54, 6],
    needed: |_, options| options.guides,
    params: Some(Params::LAYOUT),
    // Hits come from passes whose indices `check_world` and `Trees::build` validated.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the guides shader for one sub-frame.
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
