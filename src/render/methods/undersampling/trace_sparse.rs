//! Trace sparse: traces the rays of one of several listed pixels, and lists the others.

use crate::pipeline::{prelude::*, recorder::clear_texture};

/// See `shaders/methods/undersampling/trace_sparse.wgsl`.
pub const PASS: Pass = Pass {
    name: "trace_sparse",
    group: PassGroup::Reflection,
    color: [162, 0, 252],
    reads_shared: &[Counters, ShadowMaps, PixelLists, DispatchSizes, MethodMaps],
    writes_shared: &[PixelLists, Counters],
    needed: |plan, _| plan.features.undersampled,
    overrides: |options| vec![("RATE", f64::from(options.reflection.rate))],
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// Clear value of pixels whose rays are not leaders: `NOT_LED` of `shaders/methods/undersampling/lib/leaders.wgsl` as
/// the instance.
const NOT_LED: wgpu::Color = wgpu::Color {
    r: 0.0,
    g: (1_u32 << 31) as f64,
    b: 0.0,
    a: 0.0,
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    if let Some(view) = frame.resources.targets.view(Target::LeadHit) {
        let label = Target::LeadHit.name();
        clear_texture(frame.recorder.encoder(), label, view, NOT_LED);
    }
    // The dispatch has workgroups for all rays, of which some find nothing left to do.
    let rays = Dispatch::Listed(List::Rays);
    frame.dispatch(pass, rays);
}
