//! Tone: linear radiance to display color.

use crate::pipeline::prelude::*;
use reflet_scene::desc::ImageDesc;

/// See `shaders/tone.wgsl`; `color` is the sum of all sub-frames.
pub const PASS: Pass = Pass {
    name: "tone",
    group: PassGroup::Picture,
    color: [251, 171, 238],
    aliases: &[("color", &[Target::ColorEven, Target::ColorOdd])],
    params: Some(Params::LAYOUT),
    overrides: |options| vec![("HAS_ALPHA", f64::from(u8::from(options.image.alpha)))],
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the tone curve.
    pub struct Params = "Params" {
        /// Exposure over the number of sub-frames.
        scale: f32,
        /// Tone curve: `TONE_*`; 0 for none.
        curve: u32,
        /// One over the number of sub-frames.
        sample_share: f32,
    }
}

impl Params {
    /// Uniforms for the image settings.
    fn new(image: &ImageDesc) -> Self {
        Self {
            scale: image.exposure_ev.ev().exp2() / image.samples.count() as f32,
            curve: image.tone_map as u32,
            sample_share: 1.0 / image.samples.count() as f32,
        }
    }
}

/// The tone pass on the device.
#[derive(Debug)]
pub struct Tone(ComputePass);

impl FramePass for Tone {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let last = builder.options.image.samples.count() - 1;
        Ok(Self(builder.compute(&PASS, &PASS.swapped(last as usize))?))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let image = &frame.options.image;
        if frame.is_last() {
            frame.dispatch_with(&self.0, &Params::new(image), Dispatch::WholePicture);
        }
    }
}
