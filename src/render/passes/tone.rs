//! Tone: linear radiance to display color.

use crate::{pipeline::prelude::*, upload::instance_records::rows};
use glam::{Affine3A, Mat3};
use reflet_scene::desc::{ImageDesc, ToneMap};

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
        /// Matrix before a filmic curve, by rows.
        inset: [[f32; 4]; 3],
        /// Matrix behind a filmic curve, by rows.
        outset: [[f32; 4]; 3],
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
        let [inset, outset] =
            matrices(image.tone_map).map(|matrix| rows(&Affine3A::from_mat3(matrix)));
        Self {
            inset,
            outset,
            scale: image.exposure_ev.ev().exp2() / image.samples.count() as f32,
            curve: image.tone_map as u32,
            sample_share: 1.0 / image.samples.count() as f32,
        }
    }
}

/// Matrices of a filmic curve: from linear sRGB to the primaries in which the curve is applied, and back to the display.
pub(crate) fn matrices(curve: ToneMap) -> [Mat3; 2] {
    match curve {
        ToneMap::None | ToneMap::Neutral => [Mat3::IDENTITY; 2],
        ToneMap::Aces => ACES,
        ToneMap::Agx => AGX,
    }
}

const ACES: [Mat3; 2] = [
    Mat3::from_cols_array_2d(&[
        [0.59719, 0.07600, 0.02840],
        [0.35458, 0.90834, 0.13383],
        [0.04823, 0.01566, 0.83777],
    ]),
    Mat3::from_cols_array_2d(&[
        [1.60475, -0.10208, -0.00327],
        [-0.53108, 1.10813, -0.07276],
        [-0.07367, -0.00605, 1.07602],
    ]),
];

const AGX: [Mat3; 2] = [
    Mat3::from_cols_array_2d(&[
        [0.842_479_05, 0.042_328_24, 0.042_375_654],
        [0.078_433_6, 0.878_468_63, 0.078_433_6],
        [0.079_223_745, 0.079_166_12, 0.879_143],
    ]),
    Mat3::from_cols_array_2d(&[
        [1.196_879, -0.052_896_85, -0.052_971_635],
        [-0.098_020_88, 1.151_903_2, -0.098_043_45],
        [-0.099_029_74, -0.098_961_174, 1.151_073_6],
    ]),
];

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
