//! Guides: color and normal of the surfaces that pixels show, means over the sub-frames, for a denoiser.

use crate::pipeline::prelude::*;

/// See `shaders/guides.wgsl`.
pub const PASS: Pass = Pass {
    name: "guides",
    group: PassGroup::Picture,
    color: [0, 54, 6],
    needed: |_, options| options.guides,
    params: Some(Sample::LAYOUT),
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};
