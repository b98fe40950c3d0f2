//! Transmit: what passes through the surfaces that pixels show.

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

/// See `shaders/transmit.wgsl`.
pub const PASS: Pass = Pass {
    name: "transmit",
    color: [120, 190, 205],
    reads: &[
        Target::Ids,
        Target::ViewDepth,
        Target::Surface,
        Target::Colors,
        Target::Details,
    ],
    writes: &[Target::TransmittedLight],
    needed: |plan, _| plan.transmission,
    overrides: |options| vec![("HIDES_BACKGROUND", f64::from(u8::from(options.image.alpha)))],
    // `check_world` and `Trees::build` validated every index that rays follow.
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

/// The pass.
#[derive(Debug)]
pub struct Transmit(ComputePass);

impl FramePass for Transmit {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        Ok(Self(builder.compute(&PASS, &[])?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        frame.dispatch(&self.0, &Dispatch::PerPixel);
    }
}
