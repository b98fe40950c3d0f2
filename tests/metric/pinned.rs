//! SSIM pinned to scikit-image, FLIP to flip-evaluator.

use super::*;

/// Case with SSIM of the frame, SSIM inside the mask, FLIP mean, p95 and p99.
type Expected = (&'static str, f64, Option<f64>, [f64; 3]);

/// Expected values, printed by `python tests/tools/test_metric_reference.py` with scikit-image 0.26.0 and
/// flip-evaluator 1.7; the pytest of that file recomputes them.
#[rustfmt::skip]
const EXPECTED: [Expected; 7] = [
        ("other_noise", 0.947461542, Some(0.944798382), [0.110302, 0.204033, 0.263547]),
        ("shifted_1_px", 0.604149448, Some(0.578442461), [0.272049, 0.521571, 0.666209]),
        ("inverted", -0.823199612, Some(-0.818862763), [0.819438, 0.974891, 0.977335]),
        ("brighter", 0.984495568, Some(0.984125427), [0.329756, 0.368071, 0.379916]),
        ("dark", 0.994708168, Some(0.994726088), [0.006306, 0.012547, 0.015083]),
        ("one_window", 0.914142727, None, [0.107811, 0.164176, 0.189947]),
        ("gray_levels", 0.966550837, None, [0.327545, 0.327545, 0.327545]),
    ];

fn case(name: &str) -> (Picture, Picture) {
    let (width, height) = match name {
        "dark" => (40, 33),
        "one_window" => (11, 11),
        "gray_levels" => (30, 20),
        _ => (64, 48),
    };
    let make = |seed| generated(width, height, seed);
    let map = |rgb: Vec<u8>, f: fn(u8) -> u8| rgb.into_iter().map(f).collect::<Vec<u8>>();
    let (test, reference) = match name {
        "other_noise" => (make(2), make(1)),
        "shifted_1_px" => (shifted(make(1), width), make(1)),
        "inverted" => (map(make(1), |v| 255 - v), make(1)),
        "brighter" => (map(make(1), |v| v + 20), make(1)),
        "dark" => (map(make(6), |v| v / 16), map(make(5), |v| v / 16)),
        "one_window" => (make(3), make(4)),
        "gray_levels" => (vec![100; 3 * width * height], vec![130; 3 * width * height]),
        _ => unreachable!("no case {name}"),
    };
    (
        picture(width, height, &test),
        picture(width, height, &reference),
    )
}

/// Rotates every row right by one pixel.
fn shifted(mut rgb: Vec<u8>, width: usize) -> Vec<u8> {
    rgb.chunks_mut(3 * width)
        .for_each(|row| row.rotate_right(3));
    rgb
}

/// The ellipse of `mask_weights` in the Python file.
fn mask(width: usize, height: usize) -> Mask {
    let (w, h) = (width as f64, height as f64);
    let weight = |i: usize| {
        let (x, y) = ((i % width) as f64, (i / width) as f64);
        let inside = ((x - w / 2.0) / (0.45 * w)).powi(2) + ((y - h / 2.0) / (0.45 * h)).powi(2);
        if inside < 1.0 {
            200.0 / 255.0
        } else {
            1.0 / 255.0
        }
    };
    let weights: Vec<f32> = (0..width * height).map(weight).collect();
    Mask::reflective(width, height, &weights).expect("finite weights")
}

#[test]
fn ssim_and_flip_match_the_reference_implementations() {
    for (name, ssim, masked_ssim, [mean, p95, p99]) in EXPECTED {
        let (test, reference) = case(name);
        let found = scores(&test, &reference, None);
        let close = |found: f64, expected: f64, tolerance: f64, what: &str| {
            assert!(
                (found - expected).abs() < tolerance,
                "{name}: {what} {found}, not {expected}"
            );
        };
        close(found.ssim.expect("large enough"), ssim, 1e-6, "SSIM");
        close(found.flip_mean, mean, 1e-4, "FLIP mean");
        close(found.flip_p95, p95, 1e-3, "FLIP p95");
        close(found.flip_p99, p99, 1e-3, "FLIP p99");
        let mask = mask(test.width(), test.height());
        assert_eq!(
            mask.is_scorable(),
            masked_ssim.is_some(),
            "{name}: {} px",
            mask.area()
        );
        if let Some(expected) = masked_ssim {
            let found = scores(&test, &reference, Some(&mask)).ssim;
            close(found.expect("scorable"), expected, 1e-6, "masked SSIM");
        }
    }
}
