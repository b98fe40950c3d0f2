//! Upsample: lists pixels with the hits of the rays around them where these agree, and the others for tracing.

use crate::pipeline::prelude::*;

/// See `shaders/methods/undersampling/upsample.wgsl`.
pub const PASS: Pass = Pass {
    name: "upsample",
    group: PassGroup::Reflection,
    color: [189, 252, 0],
    reads_shared: &[Counters, PixelLists, DispatchSizes],
    writes_shared: &[PixelLists, Counters],
    params: Some(Params::LAYOUT),
    needed: |plan, _| plan.features.undersampled,
    overrides: |options| vec![("RATE", f64::from(options.reflection.rate))],
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the upsample shader.
    pub struct Params = "Params" {
        /// Maximum angle between normals, and relative difference of distances.
        similarity: f32,
    }
}

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let params = Params {
        similarity: frame.options.reflection.similarity,
    };
    // The dispatch has workgroups for all rays, of which some find nothing left to do.
    let rays = Dispatch::Listed(List::Rays);
    frame.dispatch_with(pass, &params, rays);
}
