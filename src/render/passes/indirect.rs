//! Indirect: path traced diffuse light between surfaces, at the surfaces of pixels.

use crate::{
    gpu::{Checks, GpuError},
    render::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
        targets::Target,
    },
};

/// See `shaders/indirect.wgsl`.
pub const PASS: Pass = Pass {
    name: "indirect",
    color: [150, 190, 110],
    reads: &[
        Target::ViewDepth,
        Target::Surface,
        Target::Colors,
        Target::Details,
    ],
    writes: &[Target::IndirectLight],
    needed: |plan, _| plan.features.indirect,
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// The indirect pass on the device.
#[derive(Debug)]
pub struct Indirect(ComputePass);

impl FramePass for Indirect {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::PerPixel);
    }
}
