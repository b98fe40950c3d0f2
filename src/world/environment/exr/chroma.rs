//! Colors of OpenEXR's luminance and chroma: Y, RY = (R - Y) / Y and BY = (B - Y) / Y, the chroma of every pixel or of
//! every second one ("Technical Introduction to OpenEXR", "Luminance/Chroma Images").

use glam::DVec3;

use super::super::pixels::Pixels;

/// Weights of the samples at distances of 1, 3, 5, … on either side of a pixel between them, of OpenEXR's filter
/// (`ImfRgbaYca.cpp`, `reconstructChromaHoriz`).
const BETWEEN: [f32; 7] = [
    0.627123, -0.186077, 0.087929, -0.043159, 0.019597, -0.007540, 0.002128,
];

/// Place of samples of chroma along an axis of the picture, pixels.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    /// First pixel of the data inside of the picture, and the pixel behind its last one.
    pub range: [i64; 2],
    /// A pixel with a sample, also outside of the picture.
    pub origin: i64,
    /// Distance of samples, 1 or 2.
    pub step: i64,
}

impl Axis {
    fn has_sample(&self, at: i64) -> bool {
        (at - self.origin).rem_euclid(self.step) == 0
    }

    /// Pixels without a sample, each with the weights of pixels that have one.
    fn between(self) -> impl Iterator<Item = (i64, [(i64, f32); 14])> {
        let samples = || (self.range[0]..self.range[1]).filter(move |at| self.has_sample(*at));
        let ends = samples().next().zip(samples().next_back());
        let missing = (self.range[0]..self.range[1]).filter(move |at| !self.has_sample(*at));
        let weighted = move |at: i64| {
            let (first, last) = ends?;
            let mut weights = [(at, 0.0); 14];
            for (k, weight) in BETWEEN.into_iter().enumerate() {
                let distance = 2 * k as i64 + 1;
                weights[2 * k] = ((at - distance).clamp(first, last), weight);
                weights[2 * k + 1] = ((at + distance).clamp(first, last), weight);
            }
            Some((at, weights))
        };
        missing.filter_map(weighted)
    }
}

/// Turns RY, Y and BY in place of red, green and blue into colors. `luminance` are the luminances of the primaries.
pub(super) fn to_rgb(pixels: &mut Pixels, [across, down]: [Axis; 2], luminance: DVec3) {
    let width = i64::from(pixels.width);
    let mut fill = |to: usize, from: [(usize, f32); 14]| {
        for lane in [0, 2] {
            let weighted = from
                .iter()
                .map(|(at, weight)| pixels.rgb[*at][lane] * weight);
            pixels.rgb[to][lane] = weighted.sum();
        }
    };
    for (x, from) in across.between() {
        for y in (down.range[0]..down.range[1]).filter(|y| down.has_sample(*y)) {
            let at = |x: i64| (y * width + x) as usize;
            fill(at(x), from.map(|(x, weight)| (at(x), weight)));
        }
    }
    for (y, from) in down.between() {
        for x in across.range[0]..across.range[1] {
            let at = |y: i64| (y * width + x) as usize;
            fill(at(y), from.map(|(y, weight)| (at(y), weight)));
        }
    }
    let [of_red, of_green, of_blue] = luminance.as_vec3().to_array();
    for color in &mut pixels.rgb {
        let [ry, y, by] = *color;
        let (red, blue) = ((ry + 1.0) * y, (by + 1.0) * y);
        *color = [red, (y - of_red * red - of_blue * blue) / of_green, blue];
    }
}
