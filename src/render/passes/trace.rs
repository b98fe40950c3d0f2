//! Trace: follows the mirror rays of the listed pixels through the BVHs, bounce by bounce.

use crate::{
    pipeline::{
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        ray_list::List,
        shared_data::SharedData,
        sub_frame::SubFrame,
    },
    settings::options::RenderOptions,
};
use reflet_gpu::Checks;

/// See `shaders/trace.wgsl`.
pub const PASS: Pass = Pass {
    name: "trace",
    group: PassGroup::Reflection,
    color: [231, 76, 116],
    reads_shared: &[
        SharedData::Counters,
        SharedData::ShadowMaps,
        SharedData::PixelLists,
        SharedData::DispatchSizes,
        SharedData::MethodMaps,
    ],
    writes_shared: &[SharedData::Counters],
    needed: |plan, options| plan.features.reflections && is_enabled(options),
    // `check_world` and `Trees::build` validated every index that tracing follows.
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// Whether the method traces the rays that the march cannot answer.
pub fn is_enabled(options: &RenderOptions) -> bool {
    options.reflection.method.traces()
}

/// Variant that traces the same rays without shading, timed apart from the frame.
pub const TRAVERSE: Pass = Pass {
    name: "traverse",
    ..PASS
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let rays = Dispatch::Listed(frame.resources.ray_list, List::Rays);
    frame.dispatch(pass, &rays);
    if let Some(traverse) = frame.instruments.traverse(frame.instrument) {
        frame.dispatch(traverse, &rays);
    }
}
