//! Hits: shades the screen hits of the march, at the points where the rays meet the surfaces.

use crate::pipeline::{
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    ray_list::List,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::Checks;

use super::ssr;

/// See `shaders/hits.wgsl`.
pub const PASS: Pass = Pass {
    name: "hits",
    group: PassGroup::Reflection,
    color: [114, 65, 79],
    reads_shared: &[
        SharedData::Counters,
        SharedData::ShadowMaps,
        SharedData::PixelLists,
        SharedData::DispatchSizes,
    ],
    writes_shared: &[SharedData::Counters],
    needed: ssr::PASS.needed,
    // The shader's ids come from the visibility pass, which `check_world` validated, and shadow rays follow indices
    // that `Trees::build` validated.
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let hits = Dispatch::Listed(frame.resources.ray_list, List::Hits);
    frame.dispatch(pass, &hits);
}
