//! Hits: shades the screen hits of the march, at the points where the rays meet the surfaces.

use crate::pipeline::prelude::*;

use super::ssr;

/// See `shaders/hits.wgsl`.
pub const PASS: Pass = Pass {
    name: "hits",
    group: PassGroup::Reflection,
    color: [114, 65, 79],
    reads_shared: &[Counters, ShadowMaps, PixelLists, DispatchSizes],
    writes_shared: &[Counters],
    needed: ssr::PASS.needed,
    checks: Checks::TrustedBuiltin,
    counted: true,
    ..Pass::DEFAULT
};
