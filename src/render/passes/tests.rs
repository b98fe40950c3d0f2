//! Tests of the list of passes.

use super::*;
use reflet_base::math::linear_from_srgb;

/// Minimum distance in OKLab between the colors of any two passes, and of passes that follow each other.
const APART: [f32; 2] = [0.1, 0.15];

/// Color in OKLab (Ottosson 2020), in which equal distances look about equally large.
fn ok_lab(srgb: [u8; 3]) -> [f32; 3] {
    let [r, g, b] = srgb.map(|value| linear_from_srgb(f32::from(value) / 255.0));
    let cone = |weights: [f32; 3]| (weights[0] * r + weights[1] * g + weights[2] * b).cbrt();
    let [l, m, s] = [
        cone([0.412_221_5, 0.536_332_5, 0.051_446]),
        cone([0.211_903_5, 0.680_699_5, 0.107_397]),
        cone([0.088_302_5, 0.281_718_8, 0.629_978_7]),
    ];
    [
        0.210_454_3 * l + 0.793_617_8 * m - 0.004_072 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904 * l + 0.782_771_8 * m - 0.808_675_8 * s,
    ]
}

#[test]
fn colors_of_passes_are_told_apart() {
    for (i, a) in ALL.iter().enumerate() {
        for (j, b) in ALL.iter().enumerate().skip(i + 1) {
            let [a_lab, b_lab] = [a, b].map(|pass| ok_lab(pass.color));
            let squares = a_lab.iter().zip(b_lab).map(|(x, y)| (x - y) * (x - y));
            let distance = squares.sum::<f32>().sqrt();
            let least = APART[usize::from(j == i + 1)];
            assert!(distance >= least, "{} and {}: {distance}", a.name, b.name);
        }
    }
}
