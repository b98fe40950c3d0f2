//! Indirect: path traced diffuse light between surfaces, at the surfaces of pixels.

use crate::pipeline::prelude::*;

use super::paths;

/// See `shaders/paths.wgsl`.
pub const PASS: Pass = Pass {
    name: "indirect",
    group: PassGroup::Light,
    color: [190, 120, 55],
    aliases: &[("path_light", &[Target::IndirectLight])],
    leaves: &[Target::Cause, Target::Hit, Target::Ids],
    reads_shared: &[ShadowMaps],
    needed: |plan, _| plan.features.indirect,
    ..paths::SHARED
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let light = paths::RECEIVED_LIGHT;
    frame.dispatch_with(pass, &paths::Params::new(light), Dispatch::PerPixel);
}
