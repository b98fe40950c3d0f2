//! Trace: follows the mirror rays of the listed pixels through the trees, bounce by bounce.

use crate::render::{pass::Pass, targets::Target};

/// See `shaders/trace.wgsl`.
pub const PASS: Pass = Pass {
    name: "trace",
    reads: &[
        Target::ViewDepth,
        Target::Surface,
        Target::BaseColor,
        Target::Emission,
    ],
    writes: &[Target::Reflection, Target::Hit],
    params: None,
};

/// The same rays without shading, timed apart from the frame.
pub const TRAVERSE: Pass = Pass {
    name: "traverse",
    ..PASS
};
