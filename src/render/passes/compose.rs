//! Compose: puts the reflection in place of the mirror term and sums the sub-frames.

use crate::pipeline::prelude::*;

/// See `shaders/compose.wgsl`; `color` and `previous` swap targets after each sub-frame.
pub const PASS: Pass = Pass {
    name: "compose",
    group: PassGroup::Picture,
    color: [204, 105, 205],
    aliases: &[
        ("color", &[Target::ColorEven, Target::ColorOdd]),
        ("previous", &[Target::ColorOdd, Target::ColorEven]),
    ],
    params: Some(Sample::LAYOUT),
    is_written: |options, target| target != Target::ColorOdd || options.image.samples.count() > 1,
    ..Pass::DEFAULT
};

/// Records the pass: one of the passes for even and odd sub-frames.
pub fn record(passes: &[ComputePass], frame: &mut SubFrame<'_>) {
    frame.dispatch_sample(&passes[frame.share.sample as usize % 2]);
}
