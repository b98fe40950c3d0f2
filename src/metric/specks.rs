//! Specks: single pixels that stand out from their surroundings, as where one ray of few found a lamp, or nothing.

use rayon::prelude::*;

/// Difference from the median of the surroundings above which a pixel is a speck, display values from 0 to 255.
pub const SPECK: f32 = 0.3 * 255.0;
/// Number of pixels from the middle to the edge of the surroundings: 5 × 5 pixels.
const REACH: usize = 2;

/// For each pixel whether it is a speck of `test` and not of `reference`: whether a channel differs by more than
/// [`SPECK`] from its median over 5 × 5 pixels. Both are pictures of `width` × `height` display values.
pub fn specks([width, height]: [usize; 2], test: &[[f32; 3]], reference: &[[f32; 3]]) -> Vec<bool> {
    let is_new = |i: usize| {
        let at = [i % width, i / width];
        is_speck(test, [width, height], at) && !is_speck(reference, [width, height], at)
    };
    (0..width * height).into_par_iter().map(is_new).collect()
}

fn is_speck(picture: &[[f32; 3]], [width, height]: [usize; 2], [x, y]: [usize; 2]) -> bool {
    let own = picture[y * width + x];
    let rows = y.saturating_sub(REACH)..(y + REACH + 1).min(height);
    let columns = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
    (0..3).any(|channel| {
        let mut around = [0.0; (2 * REACH + 1) * (2 * REACH + 1)];
        let mut count = 0;
        for row in rows.clone() {
            for column in columns.clone() {
                around[count] = picture[row * width + column][channel];
                count += 1;
            }
        }
        let (_, median, _) = around[..count].select_nth_unstable_by(count / 2, f32::total_cmp);
        (own[channel] - *median).abs() > SPECK
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_pixels_are_specks_and_edges_are_none() {
        let size = [9, 7];
        let step: Vec<_> = (0..63)
            .map(|i| if i % 9 < 4 { [20.0; 3] } else { [220.0; 3] })
            .collect();
        assert!(!specks(size, &step, &vec![[0.0; 3]; 63]).contains(&true));
        // A black pixel in the light, a blue one in the dark, and one that differs too little, at a corner.
        let mut test = step.clone();
        test[3 * 9 + 7] = [0.0; 3];
        test[5 * 9 + 1] = [20.0, 20.0, 150.0];
        test[0] = [90.0; 3];
        let found: Vec<_> = (0..63).filter(|i| specks(size, &test, &step)[*i]).collect();
        assert_eq!(found, [3 * 9 + 7, 5 * 9 + 1]);
        // Specks of the reference are none of the test's.
        assert!(!specks(size, &test, &test).contains(&true));
    }
}
