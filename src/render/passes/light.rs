//! Light: view-independent radiance, apart from the specular of this view.

use crate::render::{pass::Pass, targets::Target};

/// See `shaders/light.wgsl`.
pub const PASS: Pass = Pass {
    name: "light",
    reads: &[
        Target::ViewDepth,
        Target::Surface,
        Target::BaseColor,
        Target::Emission,
    ],
    writes: &[Target::Radiance, Target::Specular],
    params: None,
};
