//! Surface: resolves the G-buffer in compute from the ids of the visibility pass, and lists the reflective and the
//! transmissive pixels.

use crate::{pipeline::prelude::*, plan::has_primary_rays};

use super::ssr;

/// See `shaders/surface.wgsl`.
pub const PASS: Pass = Pass {
    name: "surface",
    group: PassGroup::Surfaces,
    color: [147, 202, 253],
    reads_shared: &[CulledDepth],
    writes_shared: &[DepthPyramid, PixelLists, Counters],
    overrides: |options| {
        let flag = |on| f64::from(u8::from(on));
        vec![
            ("MARCH", flag(ssr::is_enabled(options))),
            ("RASTERIZED", flag(!has_primary_rays(options))),
        ]
    },
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};
