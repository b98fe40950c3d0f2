//! Masks: selected pixels, erosion, and their effect on metrics.

use super::*;

#[test]
fn background_hides_a_wrong_reflection() {
    // A reflection over about 17 % of the frame is unrelated to the reference; the rest is equal. Over the frame SSIM
    // is over 0.8, inside the mask it is next to nothing.
    let (width, height) = (160, 120);
    let reflects = |i: usize| (30..110).contains(&(i % width)) && (40..80).contains(&(i / width));
    let reference = generated(width, height, 1);
    let mut test = reference.clone();
    let mut random = Random(3);
    let mut weights = vec![0.0; width * height];
    for i in (0..width * height).filter(|i| reflects(*i)) {
        weights[i] = 0.3;
        test[3 * i..3 * i + 3].copy_from_slice(&random.bytes(3));
    }
    let mask = Mask::reflective(width, height, &weights).expect("finite");
    assert_eq!(mask.area(), 70 * 30);
    let [test, reference] = [test, reference].map(|rgb| picture(width, height, &rgb));
    let frame = scores(&test, &reference, None);
    let inside = scores(&test, &reference, Some(&mask));
    let [frame_ssim, inside_ssim] = [frame.ssim, inside.ssim].map(|s| s.expect("scored"));
    assert!((0.75..0.9).contains(&frame_ssim), "{frame_ssim}");
    assert!(inside_ssim.abs() < 0.1, "{inside_ssim}");
    assert!(inside.flip_mean > 4.0 * frame.flip_mean);
    assert!(inside.psnr_db < frame.psnr_db - 5.0);
    assert!(inside.rel_mse > 4.0 * frame.rel_mse);
    assert_eq!(inside.area_px, 70 * 30);
    assert!((inside.area_share - 2100.0 / 19_200.0).abs() < 1e-12);
}

#[test]
fn errors_outside_the_mask_do_not_count_inside() {
    let (width, height) = (80, 60);
    let reference = generated(width, height, 1);
    let mut test = reference.clone();
    test[..3 * width * 10].fill(255); // the ten top rows
    let weights: Vec<f32> = (0..width * height)
        .map(|i| (i / width >= 20) as u8 as f32)
        .collect();
    let mask = Mask::reflective(width, height, &weights).expect("finite");
    let [test, reference] = [test, reference].map(|rgb| picture(width, height, &rgb));
    let inside = scores(&test, &reference, Some(&mask));
    assert_eq!(inside.ssim, Some(1.0));
    assert_eq!(
        (inside.psnr_db, inside.rel_mse, inside.max_difference),
        (f64::INFINITY, 0.0, 0.0)
    );
    assert_eq!(inside.flip_mean, 0.0); // its filters reach 10 px; the mask starts 15 px below
}

#[test]
fn erosion_asks_the_whole_neighborhood() {
    let mut random = Random(11);
    for (width, height) in [(37, 23), (1, 9), (12, 12), (30, 11)] {
        for radius in [0, 1, 2, 5] {
            let dense = |_| {
                if random.next().is_multiple_of(97) {
                    0.0
                } else {
                    1.0
                }
            };
            let weights: Vec<f32> = (0..width * height).map(dense).collect();
            let mask = Mask::from_weights(width, height, &weights).expect("finite");
            let eroded = mask.eroded(radius);
            let r = radius as isize;
            let at = |x: isize, y: isize| {
                let within = x >= 0 && y >= 0 && x < width as isize && y < height as isize;
                within && weights[y as usize * width + x as usize] > 0.5
            };
            for (i, inside) in eroded.inside().iter().enumerate() {
                let (x, y) = ((i % width) as isize, (i / width) as isize);
                let all = (-r..=r).all(|dy| (-r..=r).all(|dx| at(x + dx, y + dy)));
                assert_eq!(
                    *inside, all,
                    "{width} × {height}, radius {radius}, {x}, {y}"
                );
            }
            assert_eq!(
                eroded.area(),
                eroded.inside().iter().filter(|b| **b).count()
            );
            assert_eq!(eroded.size(), [width, height]);
        }
    }
}

#[test]
fn a_weight_must_exceed_one_level() {
    let weights = [0.0, 1.0 / 255.0, 1.001 / 255.0, 1.0, -1.0, 5.0];
    let mask = Mask::from_weights(3, 2, &weights).expect("finite");
    assert_eq!(mask.inside(), [false, false, true, true, false, true]);
}

#[test]
fn mask_pictures_hold_weights_as_data() {
    let weights = |encoding, color| flat(1, 1, encoding, color).weights()[0];
    assert_eq!(weights(Encoding::Display, [255.0, 0.0, 3.0]), 1.0);
    assert_eq!(weights(Encoding::Display, [1.0, 1.0, 1.0]), 1.0 / 255.0);
    assert_eq!(weights(Encoding::Linear, [0.25, 0.5, 0.125]), 0.5);
}

#[test]
fn a_hundred_pixels_are_enough() {
    let square = |side: usize| {
        let width = side + 10; // the eroded border
        Mask::reflective(width, width, &vec![1.0; width * width]).expect("finite")
    };
    assert_eq!((square(10).area(), square(10).is_scorable()), (100, true));
    assert_eq!((square(9).area(), square(9).is_scorable()), (81, false));
}

#[test]
fn weights_that_are_no_mask_are_refused() {
    assert!(matches!(
        Mask::from_weights(2, 2, &[0.0, 1.0, f32::NAN, 1.0]),
        Err(PictureError::Value {
            count: 1,
            first: [0, 1],
            ..
        })
    ));
    assert!(Mask::from_weights(2, 2, &[0.0; 3]).is_err());
    assert!(Mask::from_weights(0, 0, &[]).is_err());
}
