//! Metric invariants and closed forms.

use reflet::metric::{flip, ssim::SsimMap};

use super::*;

#[test]
fn equal_pictures_have_no_error() {
    for (seed, width, height) in [(1, 64, 48), (2, 11, 11), (3, 97, 13), (4, 1, 1), (5, 3, 40)] {
        let same = picture(width, height, &generated(width, height, seed));
        let found = scores(&same, &same, None);
        assert_eq!(found.ssim, (width >= 11 && height >= 11).then_some(1.0));
        assert_eq!([found.flip_mean, found.flip_p95, found.flip_p99], [0.0; 3]);
        assert_eq!(found.psnr_db, f64::INFINITY);
        assert_eq!(
            [found.rel_mse, found.rel_mse_trimmed, found.max_difference],
            [0.0; 3]
        );
        assert_eq!((found.area_px, found.area_share), (width * height, 1.0));
    }
}

#[test]
fn order_matters_to_rel_mse_alone() {
    let mut random = Random(7);
    for _ in 0..8 {
        let [a, b] = [(); 2].map(|()| picture(30, 20, &random.bytes(3 * 30 * 20)));
        let (ab, ba) = (scores(&a, &b, None), scores(&b, &a, None));
        assert_eq!(ab.ssim, ba.ssim);
        assert!((ab.flip_mean - ba.flip_mean).abs() < 1e-6);
        assert_eq!(
            (ab.psnr_db, ab.max_difference),
            (ba.psnr_db, ba.max_difference)
        );
        assert_ne!(ab.rel_mse, ba.rel_mse);
        let ssim = ab.ssim.expect("large enough");
        assert!((-1.0..1.0).contains(&ssim), "{ssim}");
        assert!(ab.flip_mean > 0.0 && ab.flip_mean <= ab.flip_p99 && ab.flip_p99 <= 1.0);
    }
}

#[test]
fn flat_pictures_have_closed_forms() {
    let test = flat(16, 16, Encoding::Display, [60.0, 60.0, 60.0]);
    let reference = flat(16, 16, Encoding::Display, [80.0, 80.0, 80.0]);
    let found = scores(&test, &reference, None);
    // Without variance only the luminance term is left, (2ab + C1) / (a² + b² + C1).
    let expected = (2.0 * 60.0 * 80.0 + 6.5025) / (60.0 * 60.0 + 80.0 * 80.0 + 6.5025);
    assert!((found.ssim.expect("large enough") - expected).abs() < 1e-9);
    assert!((found.psnr_db - 20.0 * (255.0_f64 / 20.0).log10()).abs() < 1e-9);
    assert_eq!(found.max_difference, 20.0);
}

#[test]
fn a_channel_counts_for_a_third() {
    let test = flat(16, 16, Encoding::Display, [0.0, 90.0, 0.0]);
    let reference = flat(16, 16, Encoding::Display, [0.0, 100.0, 0.0]);
    let found = scores(&test, &reference, None);
    let expected = 10.0 * (255.0_f64 * 255.0 / (10.0 * 10.0 / 3.0)).log10();
    assert!((found.psnr_db - expected).abs() < 1e-9);
    assert_eq!(found.max_difference, 10.0);
}

#[test]
fn rel_mse_is_taken_in_linear_light() {
    let test = flat(16, 16, Encoding::Linear, [5.0, 5.0, 5.0]);
    let reference = flat(16, 16, Encoding::Linear, [2.0, 2.0, 2.0]);
    let found = scores(&test, &reference, None);
    assert!((found.rel_mse - (3.0_f64 / 2.01).powi(2)).abs() < 1e-9);
    // Both colors are over white, so that a display shows them equal.
    assert_eq!((found.ssim, found.max_difference), (Some(1.0), 0.0));
    let black = flat(16, 16, Encoding::Linear, [0.0; 3]);
    let found = scores(&flat(16, 16, Encoding::Linear, [0.02; 3]), &black, None);
    assert!((found.rel_mse - 4.0).abs() < 1e-6);
    // sRGB 188 decodes to 0.502886 (IEC 61966-2-1).
    let found = scores(&flat(16, 16, Encoding::Display, [188.0; 3]), &black, None);
    assert!((found.rel_mse.sqrt() - 50.2886).abs() < 1e-3);
}

#[test]
fn trimming_drops_one_pixel_in_a_thousand() {
    let pair = |pixels: usize, wrong: usize| {
        let reference = flat(pixels, 1, Encoding::Linear, [0.5; 3]);
        let mut test = reference.pixels().to_vec();
        test[..wrong].fill([9.0; 3]);
        let test = Picture::new(pixels, 1, Encoding::Linear, test).expect("a picture");
        scores(&test, &reference, None)
    };
    assert!(pair(2000, 2).rel_mse > 0.0);
    assert_eq!(pair(2000, 2).rel_mse_trimmed, 0.0);
    assert!(pair(2000, 3).rel_mse_trimmed > 0.0);
    let few = pair(999, 1);
    assert_eq!(few.rel_mse, few.rel_mse_trimmed);
}

#[test]
fn a_pixel_changes_the_windows_that_cover_it() {
    let (width, height) = (40, 30);
    let plane: Vec<f64> = generated(width, height, 1)
        .chunks(3)
        .map(|p| p[0].into())
        .collect();
    let mut changed = plane.clone();
    changed[14 * width + 20] += 60.0;
    let map = SsimMap::of_luma(width, height, &plane, &changed).expect("large enough");
    for i in 0..width * height {
        let (x, y) = (i % width, i / width);
        let mut weights = vec![0.0; width * height];
        weights[i] = 1.0;
        let center = Mask::from_weights(width, height, &weights).expect("finite weights");
        let value = map.mean(Some(&center));
        let is_whole = (5..width - 5).contains(&x) && (5..height - 5).contains(&y);
        let covers = x.abs_diff(20) <= 5 && y.abs_diff(14) <= 5;
        assert_eq!(value.is_some(), is_whole, "window around {x}, {y}");
        let is_changed = value.is_some_and(|value| value < 1.0);
        assert_eq!(is_changed, covers, "window around {x}, {y}: {value:?}");
    }
}

#[test]
fn a_shift_costs_more_the_farther_it_goes() {
    let (width, height) = (64, 64);
    let wave = |shift: f32| {
        let pixels = (0..width * height).map(|i| {
            let x = (i % width) as f32 + shift;
            [127.0 + 100.0 * (x / 12.0).sin(); 3]
        });
        Picture::new(width, height, Encoding::Display, pixels.collect()).expect("a picture")
    };
    let reference = wave(0.0);
    let found = [0.5, 1.0, 2.0, 4.0, 8.0].map(|shift| scores(&wave(shift), &reference, None));
    for pair in found.windows(2) {
        assert!(pair[0].ssim > pair[1].ssim);
        assert!(pair[0].flip_mean < pair[1].flip_mean);
        assert!(pair[0].psnr_db > pair[1].psnr_db);
        assert!(pair[0].rel_mse < pair[1].rel_mse);
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let [a, b] = [1, 2].map(|seed| picture(200, 150, &generated(200, 150, seed)));
    let pair = Pair::new(&a, &b).expect("one size");
    let [one, four] = [1, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool")
            .install(|| Maps::compare(&pair).scores(None))
    });
    assert_eq!(one, four);
}

#[test]
fn flip_quantizes_to_eight_bits_and_colors_with_magma() {
    let [a, b] = [100.0, 100.4].map(|v| vec![[v; 3]; 400]);
    assert!(flip::flip_map(20, 20, &a, &b).iter().all(|v| *v == 0.0));
    let heat = flip::heat(&[0.0, 1.0]);
    assert!(heat[..3].iter().all(|v| *v < 8), "{heat:?}");
    assert!(heat[3] > 240 && heat[4] > 240 && heat[5] > 180, "{heat:?}");
}

#[test]
fn numbers_that_are_no_picture_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.001] {
        let mut pixels = vec![[0.5; 3]; 12];
        pixels[7][2] = bad;
        pixels[9][0] = bad;
        let result = Picture::new(4, 3, Encoding::Linear, pixels);
        let message = result.as_ref().expect_err("bad values").to_string();
        assert!(message.starts_with("2 pixels hold NaN"), "{message}");
        match result {
            Err(PictureError::Value { count, first, .. }) => {
                assert_eq!((count, first), (2, [3, 1]))
            }
            other => panic!("{bad}: {other:?}"),
        }
    }
    let shape = |w, h, n| Picture::new(w, h, Encoding::Linear, vec![[0.0; 3]; n]).is_err();
    assert!(shape(4, 3, 11) && shape(0, 0, 0) && shape(usize::MAX, 3, 12) && !shape(4, 3, 12));
    assert!(Picture::from_rgb8(2, 1, &[0; 7]).is_err());
    let [wide, tall] = [(4, 3), (3, 4)].map(|(w, h)| flat(w, h, Encoding::Linear, [0.0; 3]));
    let error = Pair::new(&wide, &tall)
        .expect_err("sizes differ")
        .to_string();
    assert!(error.contains("4 × 3 against 3 × 4"), "{error}");
}

#[test]
fn fractions_of_code_values_are_decoded_too() {
    let reference = flat(11, 11, Encoding::Display, [0.0; 3]);
    // sRGB 187.5 / 255 decodes to 0.499905 (IEC 61966-2-1).
    let found = scores(
        &flat(11, 11, Encoding::Display, [187.5; 3]),
        &reference,
        None,
    );
    assert!(
        (found.rel_mse.sqrt() - 49.9905).abs() < 1e-3,
        "{}",
        found.rel_mse.sqrt()
    );
}

#[test]
fn white_is_not_over_white() {
    let over = |v: f32| flat(2, 1, Encoding::Linear, [0.1, v, 0.1]).over_white();
    assert_eq!([over(1.0), over(1.001)], [0, 2]);
    assert_eq!(flat(2, 1, Encoding::Display, [255.0; 3]).over_white(), 0);
}
