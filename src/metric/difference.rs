//! The picture of differences.

use crate::picture::Pair;

/// |test − reference| of the display values times a gain, as RGB bytes. The gain is the largest
/// power of two from 2 to 64 that leaves 99 % of the differing channels unclipped.
pub fn difference_picture(pair: &Pair) -> (u32, Vec<u8>) {
    let (test, reference) = (pair.test().display(), pair.reference().display());
    let values = test.as_flattened().iter().zip(reference.as_flattened());
    let differences: Vec<f32> = values.map(|(a, b)| (a - b).abs()).collect();
    let mut differing: Vec<f32> = differences.iter().copied().filter(|d| *d > 0.0).collect();
    let rank = differing.len() * 99 / 100;
    let high = if differing.is_empty() {
        255.0
    } else {
        *differing.select_nth_unstable_by(rank, f32::total_cmp).1
    };
    let mut gain = 2;
    while gain < 64 && high * (2 * gain) as f32 <= 255.0 {
        gain *= 2;
    }
    let enlarge = |d: &f32| (d * gain as f32).round() as u8; // the cast clips at 255
    (gain, differences.iter().map(enlarge).collect())
}
