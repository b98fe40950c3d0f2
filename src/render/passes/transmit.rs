//! Transmit: light that passes through the surfaces of the listed pixels.

use crate::pipeline::{
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    ray_list::List,
    recorder::clear_texture,
    shared_data::SharedData,
    sub_frame::SubFrame,
    targets::Target,
};
use reflet_gpu::Checks;

use super::ssr;

/// See `shaders/transmit.wgsl`.
pub const PASS: Pass = Pass {
    name: "transmit",
    group: PassGroup::Light,
    color: [253, 208, 126],
    reads_shared: &[
        SharedData::Counters,
        SharedData::ShadowMaps,
        SharedData::PixelLists,
        SharedData::DispatchSizes,
    ],
    writes_shared: &[SharedData::Counters],
    needed: |plan, _| plan.features.transmission,
    overrides: |options| {
        let flag = |on| f64::from(u8::from(on));
        vec![
            ("MARCH", flag(ssr::is_enabled(options))),
            ("HIDES_BACKGROUND", flag(options.image.alpha)),
        ]
    },
    // `check_world` and `Trees::build` validated every index that rays follow.
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
    let transmissive = Dispatch::Listed(frame.resources.ray_list, List::Transmissive);
    frame.dispatch(pass, &transmissive);
}
