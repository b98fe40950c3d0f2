//! The mask of reflective pixels: where a reflection can be seen and judged.

use crate::bench::picture::{PictureError, check_values};

/// A pixel counts as reflective when its Fresnel-weighted reflectance exceeds this: less can not
/// change an 8-bit display value by a level.
pub const MIN_WEIGHT: f32 = 1.0 / 255.0;
/// The mask shrinks by this many pixels, so that windows and filters see little of what is around.
pub const ERODE_PX: usize = 5;
/// Fewer pixels than this are not scored.
pub const MIN_AREA_PX: usize = 100;

/// A set of pixels of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    width: usize,
    inside: Vec<bool>,
    area: usize,
}

impl Mask {
    /// The pixels whose weight exceeds [`MIN_WEIGHT`], eroded by [`ERODE_PX`]: what is scored.
    ///
    /// # Errors
    /// When `weights` is empty, not `width * height` long, or holds NaN or an infinity.
    pub fn reflective(width: usize, height: usize, weights: &[f32]) -> Result<Self, PictureError> {
        Self::from_weights(width, height, weights).map(|mask| mask.eroded(ERODE_PX))
    }

    /// The pixels whose weight exceeds [`MIN_WEIGHT`].
    ///
    /// # Errors
    /// When `weights` is empty, not `width * height` long, or holds NaN or an infinity.
    pub fn from_weights(
        width: usize,
        height: usize,
        weights: &[f32],
    ) -> Result<Self, PictureError> {
        if weights.is_empty() || width.checked_mul(height) != Some(weights.len()) {
            return Err(PictureError::Shape {
                width,
                height,
                pixels: weights.len(),
            });
        }
        check_values(width, weights.as_chunks::<1>().0, f32::is_finite)?;
        let inside = weights.iter().map(|w| *w > MIN_WEIGHT).collect();
        Ok(Self::of(width, inside))
    }

    /// The pixels whose square neighborhood of `2 * radius + 1` pixels lies wholly inside; what
    /// is beyond the frame counts as outside.
    pub fn eroded(&self, radius: usize) -> Self {
        let (width, height) = (self.width, self.inside.len() / self.width);
        let mut rows = vec![false; self.inside.len()];
        for y in 0..height {
            let row = y * width..(y + 1) * width;
            erode_line(&self.inside, &mut rows, row.start, 1, width, radius);
        }
        let mut inside = vec![false; self.inside.len()];
        for x in 0..width {
            erode_line(&rows, &mut inside, x, width, height, radius);
        }
        Self::of(width, inside)
    }

    fn of(width: usize, inside: Vec<bool>) -> Self {
        let area = inside.iter().filter(|inside| **inside).count();
        Self {
            width,
            inside,
            area,
        }
    }

    /// Pixels inside.
    pub fn area(&self) -> usize {
        self.area
    }

    /// Whether there are enough pixels to score: [`MIN_AREA_PX`].
    pub fn is_scorable(&self) -> bool {
        self.area >= MIN_AREA_PX
    }

    /// Pixels across and down.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.inside.len() / self.width]
    }

    /// Whether each pixel is inside, row by row.
    pub fn inside(&self) -> &[bool] {
        &self.inside
    }
}

/// Erodes `count` pixels that start at `start` and lie `stride` apart.
fn erode_line(
    from: &[bool],
    to: &mut [bool],
    start: usize,
    stride: usize,
    count: usize,
    radius: usize,
) {
    let mut run = 0; // pixels inside, up to and with the current one
    for i in 0..count {
        run = if from[start + i * stride] { run + 1 } else { 0 };
        if run > 2 * radius {
            to[start + (i - radius) * stride] = true;
        }
    }
}
