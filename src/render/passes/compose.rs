//! Compose: puts the reflection in place of the mirror term and sums the sub-frames.

use crate::{
    layout::gpu_struct::gpu_struct,
    pipeline::{
        frame_pass::FramePass,
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
        targets::Target,
    },
};
use reflet_gpu::GpuError;

use super::filter;

/// See `shaders/compose.wgsl`; `color` and `previous` swap targets after each sub-frame.
pub const PASS: Pass = Pass {
    name: "compose",
    group: PassGroup::Picture,
    color: [204, 105, 205],
    aliases: &[("color", &SUMS), ("previous", &SUMS)],
    params: Some(Params::LAYOUT),
    overrides: |options| vec![("FILTER", f64::from(u8::from(filter::is_enabled(options))))],
    is_written: |options, target| target != Target::ColorOdd || options.image.samples.count() > 1,
    ..Pass::DEFAULT
};

/// Sums of the sub-frames, after even and after odd ones.
const SUMS: [Target; 2] = [Target::ColorEven, Target::ColorOdd];

gpu_struct! {
    /// Uniforms of the compose shader for one sub-frame.
    pub struct Params = "Params" {
        /// Index of the sub-frame.
        sample: u32,
    }
}

/// The compose pass on the device, for even and odd sub-frames.
#[derive(Debug)]
pub struct Compose([ComputePass; 2]);

impl FramePass for Compose {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let parity =
            |i: usize| builder.compute(&PASS, &[("color", SUMS[i]), ("previous", SUMS[1 - i])]);
        Ok(Self([parity(0)?, parity(1)?]))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let params = Params {
            sample: frame.share.sample,
        };
        let pass = &self.0[frame.share.sample as usize % 2];
        frame.dispatch_with(pass, &params, &Dispatch::PerPixel);
    }
}
