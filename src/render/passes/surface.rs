//! Surface: resolves the G-buffer in compute from the ids of the visibility pass, and lists the reflective and the
//! transmissive pixels.

use crate::{
    pipeline::{
        pass::{ComputePass, Pass, PassGroup},
        shared_data::SharedData,
        sub_frame::SubFrame,
    },
    plan::has_primary_rays,
};
use reflet_gpu::Checks;

use super::ssr;

/// See `shaders/surface.wgsl`.
pub const PASS: Pass = Pass {
    name: "surface",
    group: PassGroup::Surfaces,
    color: [147, 202, 253],
    reads_shared: &[SharedData::CulledDepth],
    writes_shared: &[
        SharedData::DepthPyramid,
        SharedData::PixelLists,
        SharedData::Counters,
    ],
    overrides: |options| {
        let flag = |on| f64::from(u8::from(on));
        vec![
            ("MARCH", flag(ssr::is_enabled(options))),
            ("RASTERIZED", flag(!has_primary_rays(options))),
        ]
    },
    // The shader's ids come from the visibility pass or from primary rays, which `check_world` and `Trees::build`
    // validated.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let surfaces = frame.surfaces();
    frame.dispatch(pass, &surfaces);
}
