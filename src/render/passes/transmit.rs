//! Transmit: light that passes through the surfaces of the listed pixels.

use crate::pipeline::{prelude::*, recorder::clear_texture};

use super::ssr;

/// See `shaders/transmit.wgsl`.
pub const PASS: Pass = Pass {
    name: "transmit",
    group: PassGroup::Light,
    color: [253, 208, 126],
    reads_shared: &[Counters, ShadowMaps, PixelLists, DispatchSizes],
    writes_shared: &[Counters],
    needed: |plan, _| plan.features.transmission,
    overrides: |options| vec![("MARCH", f64::from(u8::from(ssr::is_enabled(options))))],
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// Clear color for pixels that are not listed: no light, and no coverage behind them.
const NOTHING_BEHIND: wgpu::Color = wgpu::Color::BLACK;

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let targets = frame.resources.targets;
    if let Some(view) = targets.view(Target::TransmittedLight) {
        clear_texture(frame.recorder.encoder(), PASS.name, view, NOTHING_BEHIND);
    }
    let transmissive = Dispatch::Listed(List::Transmissive);
    frame.dispatch(pass, transmissive);
}
