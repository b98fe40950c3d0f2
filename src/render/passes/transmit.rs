//! Transmit: light that passes through the surfaces of the listed pixels.

use crate::pipeline::{prelude::*, recorder::clear_texture};

use super::paths;

/// See `shaders/paths.wgsl`.
pub const PASS: Pass = Pass {
    name: "transmit",
    group: PassGroup::Light,
    color: [253, 208, 126],
    aliases: &[("path_light", &[Target::TransmittedLight])],
    leaves: &[Target::Cause, Target::Hit],
    needed: |plan, _| plan.features.transmission,
    ..paths::SHARED
};

/// Clear color for pixels that are not listed: no light, and no coverage behind them.
const NOTHING_BEHIND: wgpu::Color = wgpu::Color::BLACK;

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let targets = frame.resources.targets;
    if let Some(view) = targets.view(Target::TransmittedLight) {
        clear_texture(frame.recorder.encoder(), PASS.name, view, NOTHING_BEHIND);
    }
    let light = paths::LIGHT_BEHIND;
    frame.dispatch_with(
        pass,
        &paths::Params::new(light),
        Dispatch::Listed(List::Transmissive),
    );
}
