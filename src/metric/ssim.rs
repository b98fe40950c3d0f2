//! Structural similarity as Wang, Bovik, Sheikh and Simoncelli define it ("Image quality
//! assessment: from error visibility to structural similarity", IEEE TIP 13(4), 2004).
//!
//! Computed on luma with 0.299, 0.587, 0.114 (Rec. 601, as in the authors' script), from display code
//! values, not rounded to whole levels; range 255; 11 × 11 Gaussian window of σ 1.5 that sums to
//! 1; population (co)variances; K₁ = 0.01, K₂ = 0.03; only windows that lie wholly in the frame;
//! full resolution, no downsampling.

use rayon::prelude::*;

use super::mask::Mask;

/// Rec. 601 luma weights of R, G and B.
pub const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
/// Pixels from the window's center to its edge.
pub const RADIUS: usize = 5;

const TAPS: usize = 2 * RADIUS + 1;
const SIGMA: f64 = 1.5;
const RANGE: f64 = 255.0;
const C1: f64 = (0.01 * RANGE) * (0.01 * RANGE);
const C2: f64 = (0.03 * RANGE) * (0.03 * RANGE);

/// SSIM of every fully covered window.
#[derive(Clone, Debug, PartialEq)]
pub struct SsimMap {
    /// Width of the pictures, pixels.
    width: usize,
    /// One value per window, row by row; `width - 10` a row. The window at column x, row y has its
    /// center at pixel (x + 5, y + 5).
    windows: Vec<f64>,
}

impl SsimMap {
    /// SSIM of two pictures of display code values; none when smaller than a window.
    ///
    /// # Panics
    /// When a picture does not hold `width * height` pixels.
    pub fn of_display(width: usize, height: usize, a: &[[f32; 3]], b: &[[f32; 3]]) -> Option<Self> {
        Self::of_luma(width, height, &luma(a), &luma(b))
    }

    /// SSIM of two planes of luma from 0 to 255; none when smaller than a window.
    ///
    /// # Panics
    /// When a plane does not hold `width * height` values.
    pub fn of_luma(width: usize, height: usize, a: &[f64], b: &[f64]) -> Option<Self> {
        assert_eq!(a.len(), width * height, "first plane");
        assert_eq!(b.len(), width * height, "second plane");
        if width < TAPS || height < TAPS {
            return None;
        }
        let window = gaussian();
        let across = width - 2 * RADIUS;
        let mut windows = vec![0.0; across * (height - 2 * RADIUS)];
        windows.par_chunks_mut(across).enumerate().for_each_init(
            || Columns::new(width),
            |columns, (y, row)| {
                let rows = y * width..(y + TAPS) * width;
                columns.filter(&a[rows.clone()], &b[rows], &window);
                for (x, value) in row.iter_mut().enumerate() {
                    *value = columns.ssim_at(x, &window);
                }
            },
        );
        Some(Self { width, windows })
    }

    /// Mean over all windows, or over those centered in the mask; none when there are no windows.
    pub fn mean(&self, mask: Option<&Mask>) -> Option<f64> {
        let across = self.width - 2 * RADIUS;
        let (mut sum, mut count) = (0.0, 0_usize);
        for (y, row) in self.windows.chunks(across).enumerate() {
            let start = (y + RADIUS) * self.width + RADIUS;
            match mask.map(|m| &m.inside()[start..start + across]) {
                None => {
                    sum += row.iter().sum::<f64>();
                    count += across;
                }
                Some(inside) => {
                    let chosen = row.iter().zip(inside).filter(|(_, inside)| **inside);
                    let (s, n) = chosen.fold((0.0, 0), |(s, n), (v, _)| (s + v, n + 1));
                    sum += s;
                    count += n;
                }
            }
        }
        (count > 0).then(|| sum / count as f64)
    }
}

/// One row of windows, weighted vertically but not yet horizontally: a, b, a², b² and ab.
struct Columns([Vec<f64>; 5]);

impl Columns {
    fn new(width: usize) -> Self {
        Self(std::array::from_fn(|_| vec![0.0; width]))
    }

    /// `a` and `b` are the eleven rows that the windows cover.
    fn filter(&mut self, a: &[f64], b: &[f64], window: &[f64; TAPS]) {
        let [mean_a, mean_b, aa, bb, ab] = &mut self.0;
        let width = mean_a.len();
        for sums in [&mut *mean_a, mean_b, aa, bb, ab] {
            sums.fill(0.0);
        }
        for ((row_a, row_b), weight) in a.chunks(width).zip(b.chunks(width)).zip(window) {
            for x in 0..width {
                let (va, vb) = (row_a[x], row_b[x]);
                mean_a[x] += weight * va;
                mean_b[x] += weight * vb;
                aa[x] += weight * (va * va);
                bb[x] += weight * (vb * vb);
                ab[x] += weight * (va * vb);
            }
        }
    }

    /// SSIM of the window whose left column is `x` (Wang et al. 2004, eq. 13 to 16).
    fn ssim_at(&self, x: usize, window: &[f64; TAPS]) -> f64 {
        let [mean_a, mean_b, aa, bb, ab] = [0, 1, 2, 3, 4].map(|plane: usize| {
            let columns = self.0[plane][x..x + TAPS].iter();
            columns.zip(window).map(|(v, w)| v * w).sum::<f64>()
        });
        let (mean_aa, mean_bb, mean_ab) = (mean_a * mean_a, mean_b * mean_b, mean_a * mean_b);
        let variances = (aa - mean_aa) + (bb - mean_bb);
        let covariance = ab - mean_ab;
        ((2.0 * mean_ab + C1) * (2.0 * covariance + C2))
            / ((mean_aa + mean_bb + C1) * (variances + C2))
    }
}

/// Gaussian weights that sum to 1.
fn gaussian() -> [f64; TAPS] {
    let weights: [f64; TAPS] = std::array::from_fn(|i| {
        let x = (i as f64 - RADIUS as f64) / SIGMA;
        (-0.5 * x * x).exp()
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|w| w / sum)
}

fn luma(pixels: &[[f32; 3]]) -> Vec<f64> {
    let dot = |p: &[f32; 3]| p.iter().zip(LUMA).map(|(v, w)| f64::from(*v) * w).sum();
    pixels.par_iter().map(dot).collect()
}
