//! Surface: resolves the G-buffer in compute from the ids of the visibility pass.

use crate::render::{pass::Pass, targets::Target};

/// See `shaders/surface.wgsl`.
pub const PASS: Pass = Pass {
    name: "surface",
    reads: &[Target::Ids],
    writes: &[
        Target::ViewDepth,
        Target::Surface,
        Target::BaseColor,
        Target::Emission,
    ],
    params: None,
};
