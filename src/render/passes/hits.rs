//! Hits: shades the screen hits of the march, at the points where the rays meet the surfaces.

use crate::pipeline::{
    frame_pass::FramePass,
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    pass_builder::PassBuilder,
    ray_list::List,
    shared_data::SharedData,
    sub_frame::SubFrame,
};
use reflet_gpu::{Checks, GpuError};

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

/// The hits pass on the device.
#[derive(Debug)]
pub struct Hits(ComputePass);

impl FramePass for Hits {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let hits = Dispatch::Listed(frame.resources.ray_list, List::Hits);
        frame.dispatch(&self.0, &hits);
    }
}
