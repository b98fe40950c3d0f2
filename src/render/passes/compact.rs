//! Compact: counts causes, lists the pixels to trace and sizes the dispatch that traces them.

use crate::render::{pass::Pass, targets::Target};

/// See `shaders/compact.wgsl`.
pub const PASS: Pass = Pass {
    name: "compact",
    reads: &[Target::Cause],
    writes: &[],
    params: None,
};

/// See `shaders/arguments.wgsl`.
pub const ARGUMENTS: Pass = Pass {
    name: "arguments",
    reads: &[],
    writes: &[],
    params: None,
};
