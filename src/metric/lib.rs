//! Metrics of a pair of pictures, over the whole frame and inside a mask: picture × picture → error.
//!
//! This crate owns what a picture to be judged is ([`picture`], read from its file by [`read`], the only module that
//! touches files), the metrics, which are pure, and their table for people and machines ([`comparison`]).

pub mod borders;
pub mod comparison;
pub mod difference;
pub mod error;
#[cfg(not(target_arch = "wasm32"))]
pub mod flip;
pub mod hits;
pub mod mask;
pub mod picture;
pub mod read;
pub mod specks;
pub mod ssim;
pub mod structure;
pub mod table;
pub mod temporal;

use std::path::Path;

use serde::Serialize;

use mask::Mask;
use reflet_scene::diagnostic::Diagnostic;

/// Every metric of one pair over one region.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scores {
    /// Number of pixels of the region.
    pub area_px: usize,
    /// Share of the frame's area in the region, 0 to 1.
    pub area_share: f64,
    /// Mean structural similarity, 1 for equal pictures; none where the frame is under 11 × 11 pixels.
    pub ssim: Option<f64>,
    /// Mean FLIP, 0 (equal) to 1.
    pub flip_mean: f64,
    /// FLIP that 95 % of the pixels do not exceed.
    pub flip_p95: f64,
    /// FLIP that 99 % of the pixels do not exceed.
    pub flip_p99: f64,
    /// Peak signal-to-noise ratio of the display values, dB; infinite (JSON: null) when equal.
    pub psnr_db: f64,
    /// Mean of (a − r)² / (r + 0.01)² in linear light.
    pub rel_mse: f64,
    /// Mean of (a − r)² / (r + 0.01)² without the 0.1 % of pixels with the largest errors.
    pub rel_mse_trimmed: f64,
    /// Largest difference of a channel, display code values from 0 to 255.
    pub max_difference: f64,
    /// Share of the pixels that stand out from their surroundings where the reference's do not, 0 to 1; see [`specks`].
    pub specks: f64,
}

/// The per-pixel errors of one pair, from which any region is scored.
#[derive(Clone, Debug)]
pub struct Maps {
    /// SSIM of every fully covered window.
    pub ssim: Option<ssim::SsimMap>,
    /// FLIP of every pixel.
    pub flip: Vec<f32>,
    /// Differences of display values and of linear light.
    pub error: error::ErrorMap,
    /// Whether each pixel is a speck.
    pub specks: Vec<bool>,
}

impl Maps {
    /// Computes all metrics of the pair.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn compare(pair: &picture::Pair) -> Self {
        let test = pair.test().display();
        let reference = pair.reference().display();
        let (width, height) = (pair.test().width(), pair.test().height());
        let ((ssim, error, specks), flip) = rayon::join(
            || {
                let ssim = ssim::SsimMap::of_display(width, height, &test, &reference);
                let error = error::ErrorMap::compare(pair, &test, &reference);
                (
                    ssim,
                    error,
                    specks::specks([width, height], &test, &reference),
                )
            },
            || flip::flip_map(width, height, &test, &reference),
        );
        Self {
            ssim,
            flip,
            error,
            specks,
        }
    }

    /// Scores the whole frame, or the inside of `mask` (of the same size).
    ///
    /// SSIM inside a mask is the mean over windows centered in it; a mask eroded by
    /// [`mask::ERODE_PX`] therefore holds only windows that lie wholly in the original one.
    ///
    /// # Panics
    /// When the mask has another size or is empty.
    pub fn scores(&self, mask: Option<&Mask>) -> Scores {
        let pixels = self.flip.len();
        if let Some(mask) = mask {
            assert_eq!(mask.inside().len(), pixels, "the mask has another size");
            assert!(mask.area() > 0, "the mask is empty");
        }
        let area_px = mask.map_or(pixels, Mask::area);
        let mut flip = select(&self.flip, mask);
        let [flip_p95, flip_p99] = [0.95, 0.99].map(|p| percentile(&mut flip, p));
        let error = self.error.pool(mask);
        Scores {
            area_px,
            area_share: area_px as f64 / pixels as f64,
            ssim: self.ssim.as_ref().and_then(|map| map.mean(mask)),
            flip_mean: mean(&flip),
            flip_p95,
            flip_p99,
            psnr_db: error.psnr_db,
            rel_mse: error.rel_mse,
            rel_mse_trimmed: error.rel_mse_trimmed,
            max_difference: error.max_difference,
            specks: select(&self.specks, mask).iter().filter(|s| **s).count() as f64
                / area_px as f64,
        }
    }
}

/// Values inside the mask, or all without one.
fn select<T: Copy>(values: &[T], mask: Option<&Mask>) -> Vec<T> {
    match mask {
        None => values.to_vec(),
        Some(mask) => values
            .iter()
            .zip(mask.inside())
            .filter_map(|(v, inside)| inside.then_some(*v))
            .collect(),
    }
}

/// Arithmetic mean; NaN for an empty slice.
fn mean(values: &[f32]) -> f64 {
    values.iter().copied().map(f64::from).sum::<f64>() / values.len() as f64
}

/// The value that the share `p` (0 to 1) of `values` does not exceed, interpolated linearly
/// between ranks (definition 7 of Hyndman and Fan 1996, NumPy's default). Reorders `values`.
///
/// # Panics
/// When there are no values.
pub fn percentile<T: Copy + Into<f64>>(values: &mut [T], p: f64) -> f64 {
    let order = |a: &T, b: &T| (*a).into().total_cmp(&(*b).into());
    let rank = p * (values.len() - 1) as f64;
    let (_, low, above) = values.select_nth_unstable_by(rank.floor() as usize, order);
    let low: f64 = (*low).into();
    let high = above.iter().copied().min_by(order);
    high.map_or(low, |high| low + rank.fract() * (high.into() - low))
}

/// Error about the file `file`, with advice.
pub fn file_error(
    name: &'static str,
    file: &Path,
    message: impl Into<String>,
    help: impl Into<String>,
) -> Box<Diagnostic> {
    Box::new(Diagnostic {
        help: Some(help.into()),
        ..Diagnostic::in_file(name, file, message)
    })
}
