//! Errors of single pixels: PSNR and maximum difference of display values, relMSE of light.

use super::{mask::Mask, select};
use crate::picture::Pair;

/// Constant added to the reference in relMSE's denominator, against division by zero at black; as in pbrt.
pub const REL_MSE_EPSILON: f64 = 0.01;
/// Share of pixels that the trimmed relMSE leaves out, rounded down.
pub const TRIM_SHARE: f64 = 0.001;

/// Per-pixel errors.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    /// Mean over the channels of the squared difference of display values.
    squared: Vec<f64>,
    /// Largest difference of a channel, display values.
    largest: Vec<f32>,
    /// Mean over the channels of (a − r)² / (r + 0.01)² in linear light.
    relative: Vec<f64>,
}

/// Errors pooled over a region; the fields stand in [`super::Scores`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PooledError {
    /// See [`super::Scores::psnr_db`].
    pub psnr_db: f64,
    /// See [`super::Scores::rel_mse`].
    pub rel_mse: f64,
    /// See [`super::Scores::rel_mse_trimmed`].
    pub rel_mse_trimmed: f64,
    /// See [`super::Scores::max_difference`].
    pub max_difference: f64,
}

impl ErrorMap {
    /// Error maps of a pair of pictures with the display values `test` and `reference`.
    pub fn compare(pair: &Pair, test: &[[f32; 3]], reference: &[[f32; 3]]) -> Self {
        let display = test.iter().zip(reference);
        let squared = display.clone().map(|(a, r)| mean_of(a, r, |d, _| d * d));
        let largest = display
            .map(|(a, r)| (a.iter().zip(r)).fold(0.0, |max: f32, (a, r)| max.max((a - r).abs())));
        let (squared, largest) = (squared.collect(), largest.collect());
        let (test, reference) = (pair.test().linear(), pair.reference().linear());
        let relative = test.iter().zip(&reference);
        let relative = relative
            .map(|(a, r)| mean_of(a, r, |d, r| (d / (r + REL_MSE_EPSILON)).powi(2)))
            .collect();
        Self {
            squared,
            largest,
            relative,
        }
    }

    /// Pools the whole frame, or the inside of a mask that is not empty.
    pub fn pool(&self, mask: Option<&Mask>) -> PooledError {
        let squared = mean(&select(&self.squared, mask));
        let largest = select(&self.largest, mask).into_iter().fold(0.0, f32::max);
        let mut relative = select(&self.relative, mask);
        let rel_mse = mean(&relative);
        let trimmed = (relative.len() as f64 * TRIM_SHARE) as usize;
        let kept = relative.len() - trimmed;
        if trimmed > 0 {
            relative.select_nth_unstable_by(kept, f64::total_cmp);
        }
        PooledError {
            psnr_db: 10.0 * (255.0 * 255.0 / squared).log10(),
            rel_mse,
            rel_mse_trimmed: mean(&relative[..kept]),
            max_difference: f64::from(largest),
        }
    }
}

/// Mean over the channels of `f(difference, reference)`.
fn mean_of(a: &[f32; 3], r: &[f32; 3], f: impl Fn(f64, f64) -> f64) -> f64 {
    let channels = a.iter().zip(r).map(|(a, r)| (f64::from(*a), f64::from(*r)));
    channels.map(|(a, r)| f(a - r, r)).sum::<f64>() / 3.0
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
