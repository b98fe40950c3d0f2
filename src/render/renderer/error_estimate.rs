//! Estimate of a picture's error from its two halves, for `samples = { error = … }`: Dammertz et al. 2010, "A
//! Hierarchical Automatic Stopping Condition for Monte Carlo Global Illumination".

use reflet_gpu::{Gpu, GpuError};
use serde::Serialize;

use super::download::Download;
use crate::pipeline::targets::Target;

/// Width and height of a tile, pixels.
const TILE_PX: usize = 16;

/// One in so many pixels of a tile, and in each tile of two pixels or more at least one, may be a speck, whose error counts as the error of the worst pixel beside them: a
/// bright and rare path would decide alone, and no bound would be met before it had converged.
const SPECKS: usize = 64;

/// Least error beyond that pixel's which makes a pixel a speck in reports: of a mid-gray some 25 of 255 steps.
const SPECK: f32 = 0.25;

/// Error of the tile that has the largest one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorEstimate {
    /// Mean over the pixels of the tile, winsorized at the worst 1 in 64: |ΔR| + |ΔG| + |ΔB| over √(R + G + B), at the
    /// picture's exposure.
    pub error: f32,
    /// Upper left pixel of the tile.
    pub tile: [u32; 2],
    /// Number of pixels of the picture whose error is larger by 0.25 than it counts.
    pub specks: u32,
}

/// Copies of the sum of the first half of the sub-frames and of the sum of all, and how to read them.
pub(crate) struct Halves {
    /// Sum of the first half, its target and its number of sub-frames.
    pub(crate) first: (Download, Target, u32),
    /// Sum of all, its target and their number.
    pub(crate) all: (Download, Target, u32),
    /// Factor of the exposure.
    pub(crate) exposure: f32,
}

/// First half of the sub-frames of the picture that is rendered.
#[derive(Default)]
pub(crate) struct FirstHalf {
    /// Whether the sum of the first half is read back.
    pub(crate) is_wanted: bool,
    pub(crate) read: Option<(Download, Target, u32)>,
}

impl std::fmt::Debug for FirstHalf {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut shown = f.debug_struct("FirstHalf");
        shown
            .field("is_wanted", &self.is_wanted)
            .finish_non_exhaustive()
    }
}

impl FirstHalf {
    /// State before a picture.
    pub(crate) fn of_picture(is_wanted: bool) -> Self {
        Self {
            is_wanted,
            read: None,
        }
    }
}

impl Halves {
    /// Waits for both sums, and compares them.
    pub(crate) fn estimate(self, gpu: &Gpu) -> Result<ErrorEstimate, GpuError> {
        let (first, target, half) = self.first;
        let first: Vec<f32> = first.take(gpu)?.texels(target);
        let (all, target, count) = self.all;
        let all = all.take(gpu)?;
        let width = all.size[0] as usize;
        let all: Vec<f32> = all.texels(target);
        Ok(estimate(&first, half, &all, count, width, self.exposure))
    }
}

/// Largest error of a tile; `first` is the sum of `half` sub-frames, `all` of `count`, in RGBA.
fn estimate(
    first: &[f32],
    half: u32,
    all: &[f32],
    count: u32,
    width: usize,
    exposure: f32,
) -> ErrorEstimate {
    let (half, count) = (half as f32, count as f32);
    let rest = count - half;
    // The variance of the difference of both means is σ² (1 / half + 1 / rest), the variance of the picture σ² / count.
    let share = (half * rest).sqrt() / count;
    let pixels = first.chunks_exact(4).zip(all.chunks_exact(4));
    let compared = pixels.map(|(first, all)| {
        let (mut difference, mut brightness) = (0.0, 0.0);
        for (first, all) in first[..3].iter().zip(&all[..3]) {
            difference += (first / half - (all - first) / rest).abs() * share;
            brightness += all / count;
        }
        (difference, brightness)
    });
    let tiles = tile_errors(compared, width, exposure);
    let largest = (tiles.iter().enumerate()).max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
    let (index, error) = largest.map_or((0, 0.0), |(index, (error, _))| (index, *error));
    let tiles_across = width.div_ceil(TILE_PX).max(1);
    let tile = [index % tiles_across, index / tiles_across];
    ErrorEstimate {
        error: error as f32,
        tile: tile.map(|at| (at * TILE_PX) as u32),
        specks: tiles.iter().map(|(_, specks)| specks).sum(),
    }
}

/// Error of each tile and its number of specks, from the difference and the brightness of each pixel.
pub(crate) fn tile_errors(
    pixels: impl ExactSizeIterator<Item = (f32, f32)>,
    width: usize,
    exposure: f32,
) -> Vec<(f64, u32)> {
    let tiles_across = width.div_ceil(TILE_PX);
    let height = pixels.len() / width.max(1);
    let mut tiles = vec![Vec::new(); tiles_across * height.div_ceil(TILE_PX)];
    for (index, (difference, brightness)) in pixels.enumerate() {
        // A pixel is black if neither half has light there.
        let error = difference * exposure / (brightness * exposure).max(1e-4).sqrt();
        tiles[index / width / TILE_PX * tiles_across + index % width / TILE_PX].push(error);
    }
    tiles.iter_mut().map(|errors| winsorized(errors)).collect()
}

/// Mean of the errors of a tile, of which the largest count as the next one, and the number of specks.
fn winsorized(errors: &mut [f32]) -> (f64, u32) {
    let worst = errors.len() - 1 - errors.len().div_ceil(SPECKS).min(errors.len() - 1);
    let most = *errors.select_nth_unstable_by(worst, f32::total_cmp).1;
    let sum: f64 = errors.iter().map(|error| f64::from(error.min(most))).sum();
    let specks = errors.iter().filter(|error| **error > most + SPECK);
    (sum / errors.len() as f64, specks.count() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_base::pcg::Pcg;

    /// Sums of gray pixels.
    fn gray(values: &[f32]) -> Vec<f32> {
        values.iter().flat_map(|v| [*v, *v, *v, 0.0]).collect()
    }

    #[test]
    fn equal_halves_have_no_error() {
        let (first, all) = (gray(&[2.0; 512]), gray(&[4.0; 512]));
        let found = estimate(&first, 4, &all, 8, 32, 1.0);
        assert_eq!(found.error, 0.0);
    }

    #[test]
    fn one_speck_does_not_decide_in_a_tile_at_the_border() {
        let (mut first, all) = (vec![1.0; 17 * 17], vec![2.0; 17 * 17]);
        first[16] = 0.0;
        let found = estimate(&gray(&first), 1, &gray(&all), 2, 17, 1.0);
        assert_eq!((found.error, found.specks), (0.0, 1));
    }

    #[test]
    fn the_noisiest_tile_counts_with_its_place() {
        // 40 × 20 pixels: three tiles across, two down; the last ones are narrower.
        let (width, height) = (40, 20);
        let (mut first, mut all) = (vec![1.0; width * height], vec![2.0; width * height]);
        for y in 16..height {
            for x in 32..width {
                (first[y * width + x], all[y * width + x]) = (1.5, 2.0);
            }
        }
        let (first, all) = (gray(&first), gray(&all));
        let found = estimate(&first, 2, &all, 4, width, 1.0);
        // Means .75 and .25; half their difference is the error of .5: 3 · .25 / √1.5.
        assert!(
            (found.error - 0.75 / 1.5_f32.sqrt()).abs() < 1e-6,
            "{found:?}"
        );
        assert_eq!(found.tile, [32, 16]);
        let twice = estimate(&first, 2, &all, 4, width, 4.0);
        assert!(
            (twice.error / found.error - 2.0).abs() < 1e-5,
            "√ of the exposure"
        );
    }

    #[test]
    fn the_estimate_is_the_error_of_random_numbers_with_few_specks_among_them() {
        // Uniform numbers in [0, 1) have σ = √(1/12); 12 sub-frames leave σ / √12 = 1/12. Mean |Δ| is √(2/π) of that.
        let mut sequence = Pcg::new(7);
        let mut number = || sequence.unit() as f32;
        let pixels = 256;
        let (mut first, mut all) = (Vec::new(), Vec::new());
        for _ in 0..pixels {
            let half: f32 = (0..5).map(|_| number()).sum();
            first.push(half);
            all.push(half + (0..7).map(|_| number()).sum::<f32>());
        }
        let want = 3.0 / 12.0 * (2.0 / std::f32::consts::PI).sqrt() / 1.5_f32.sqrt();
        for (specks, is_met) in [(0, true), (4, true), (5, false)] {
            // Paths of the second half, which bring a thousand times the light of the others.
            for (i, all) in all.iter_mut().enumerate().take(specks) {
                *all = first[i] + 5e3;
            }
            let found = estimate(&gray(&first), 5, &gray(&all), 12, 16, 1.0);
            let is_near = (found.error / want - 1.0).abs() < 0.15;
            assert_eq!(is_near, is_met, "{specks} specks: {found:?}, {want}");
            assert_eq!(found.specks, if is_met { specks as u32 } else { 0 });
        }
    }
}
