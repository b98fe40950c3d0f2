//! Mask of reflective pixels: the pixels whose reflection can be seen and scored.

use crate::picture::{PictureError, check_values};

/// Fresnel-weighted reflectance above which a pixel counts as reflective: less cannot change an 8-bit
/// display value by a level.
pub const MIN_WEIGHT: f32 = 1.0 / 255.0;
/// Number of pixels by which the mask shrinks, so that windows and filters see little of its surroundings.
pub const ERODE_PX: usize = 5;
/// Smallest mask that is scored, pixels.
pub const MIN_AREA_PX: usize = 100;

/// A set of pixels of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    width: usize,
    inside: Vec<bool>,
    area: usize,
}

impl Mask {
    /// Mask that is scored: the pixels whose weight exceeds [`MIN_WEIGHT`], eroded by [`ERODE_PX`].
    ///
    /// # Errors
    /// When `weights` is empty, not `width * height` long, or holds NaN or an infinity.
    pub fn reflective(width: usize, height: usize, weights: &[f32]) -> Result<Self, PictureError> {
        Self::from_weights(width, height, weights).map(|mask| mask.eroded(ERODE_PX))
    }

    /// Mask of the pixels whose weight exceeds [`MIN_WEIGHT`].
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
        Ok(Self::from_pixels(width, inside))
    }

    /// Erodes the mask: keeps the pixels whose square neighborhood of `2 * radius + 1` pixels lies wholly
    /// inside; pixels beyond the frame count as outside.
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
        Self::from_pixels(width, inside)
    }

    fn from_pixels(width: usize, inside: Vec<bool>) -> Self {
        let area = inside.iter().filter(|inside| **inside).count();
        Self {
            width,
            inside,
            area,
        }
    }

    /// Number of pixels inside.
    pub fn area(&self) -> usize {
        self.area
    }

    /// Whether the mask has enough pixels to be scored, [`MIN_AREA_PX`].
    pub fn is_scorable(&self) -> bool {
        self.area >= MIN_AREA_PX
    }

    /// Width and height, pixels.
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
