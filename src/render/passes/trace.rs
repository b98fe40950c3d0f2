//! Trace: follows the mirror rays of the listed pixels through the BVHs, bounce by bounce, and shades known hits, such as hits
//! of the march.

use crate::{pipeline::prelude::*, settings::options::RenderOptions};

use super::{paths, ssr};

/// See `shaders/paths.wgsl`.
pub const PASS: Pass = Pass {
    name: "trace",
    group: PassGroup::Reflection,
    color: [231, 76, 116],
    aliases: &[("path_light", &[Target::Reflection])],
    leaves: &[Target::Ids],
    reads_shared: &[Counters, ShadowMaps, PixelLists, DispatchSizes, MethodMaps],
    needed: |plan, options| {
        plan.features.reflections && (ssr::is_enabled(options) || is_enabled(options))
    },
    overrides: paths::mirror_overrides,
    ..paths::SHARED
};

/// Whether the method traces rays, which the march cannot answer where it marches.
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
    let params = paths::Params::new(paths::MIRRORED_LIGHT);
    let rays = Dispatch::Listed(List::Rays);
    frame.dispatch_with(pass, &params, rays);
    if let Some(traverse) = frame.instruments.traverse(frame.instrument) {
        frame.dispatch_with(traverse, &params, rays);
    }
}

/// Variant that follows the rays which are traced first, where only some are.
pub const LEADERS: Pass = Pass {
    name: "trace_leaders",
    color: [0, 0, 48],
    needed: |plan, _| plan.features.undersampled,
    ..PASS
};

/// Records [`LEADERS`].
pub fn record_leaders(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let params = paths::Params {
        light: paths::MIRRORED_LIGHT,
        leads: 1,
    };
    frame.dispatch_with(pass, &params, Dispatch::Listed(List::Rays));
}
