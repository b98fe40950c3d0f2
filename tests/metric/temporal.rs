//! Flicker of sequences.

use reflet::metric::{mask::MIN_AREA_PX, temporal, temporal::Temporal};

use super::*;

/// Flicker ratio of two sequences of gray levels.
fn ratio(test: &[f32], reference: &[f32]) -> Option<f64> {
    let mut sequence = Temporal::new();
    let mut changes = Vec::new();
    for (t, r) in test.iter().zip(reference) {
        let [t, r] = [t, r].map(|v| flat(4, 3, Encoding::Display, [*v; 3]));
        let pair = Pair::new(&t, &r).expect("one size");
        changes.extend(sequence.push(&pair, None).expect("one size"));
    }
    let difference = changes.iter().map(|c| c.difference).sum();
    let reference = changes.iter().map(|c| c.reference).sum();
    temporal::ratio(changes.len(), difference, reference)
}

#[test]
fn a_ratio_needs_two_frames() {
    assert_eq!(ratio(&[], &[]), None);
    assert_eq!(ratio(&[1.0], &[9.0]), None);
}

#[test]
fn static_sequence_has_no_flicker() {
    assert_eq!(ratio(&[5.0, 5.0, 5.0], &[80.0, 80.0, 80.0]), Some(0.0));
}

#[test]
fn a_constant_error_is_no_flicker() {
    assert_eq!(ratio(&[15.0, 25.0, 5.0], &[10.0, 20.0, 0.0]), Some(0.0));
}

#[test]
fn known_ratios() {
    assert_eq!(ratio(&[10.0, 10.0, 10.0], &[10.0, 20.0, 0.0]), Some(1.0)); // frozen
    assert_eq!(ratio(&[20.0, 10.0, 20.0], &[10.0, 20.0, 10.0]), Some(2.0)); // opposite
    assert_eq!(
        ratio(&[0.0, 15.0, 15.0], &[0.0, 10.0, 40.0]),
        Some(35.0 / 40.0)
    );
    assert_eq!(ratio(&[10.0, 11.0], &[10.0, 10.0]), Some(f64::INFINITY));
}

#[test]
fn a_frame_gives_its_change_since_the_one_before() {
    let mut temporal = Temporal::new();
    let mut push = |test: f32, reference: f32| {
        let [t, r] = [test, reference].map(|v| flat(4, 3, Encoding::Display, [v; 3]));
        temporal
            .push(&Pair::new(&t, &r).expect("one size"), None)
            .expect("one size")
    };
    assert_eq!(push(10.0, 10.0), None);
    let change = push(15.0, 30.0).expect("a change");
    assert_eq!((change.difference, change.reference), (15.0, 20.0));
}

#[test]
fn another_size_is_refused_and_not_added() {
    let mut temporal = Temporal::new();
    let mut push = |side: usize, gray: f32| {
        let frame = flat(side, side, Encoding::Display, [gray; 3]);
        temporal.push(&Pair::new(&frame, &frame).expect("one size"), None)
    };
    assert!(push(4, 0.0).is_ok());
    assert!(push(5, 0.0).is_err());
    let since = push(4, 9.0).expect("one size").expect("a frame before");
    assert_eq!((since.difference, since.reference), (0.0, 9.0));
}

#[test]
fn a_mask_leaves_out_what_is_outside_of_it_in_either_frame() {
    let (width, height) = (20, 20);
    // The upper half changes as the reference does, the lower one by 30 levels more.
    let frame = |upper: f32, lower: f32| {
        let pixels = (0..width * height).map(|i| [if i < 200 { upper } else { lower }; 3]);
        Picture::new(width, height, Encoding::Display, pixels.collect()).expect("a picture")
    };
    let rows = |from: usize, to: usize| {
        let inside = |i: usize| f32::from(u8::from((from..to).contains(&(i / width))));
        let weights: Vec<f32> = (0..width * height).map(inside).collect();
        Mask::from_weights(width, height, &weights).expect("a mask")
    };
    let change = |first: Mask, second: Mask| {
        let mut temporal = Temporal::new();
        let (dark, light) = (frame(10.0, 10.0), frame(20.0, 50.0));
        let reference = frame(20.0, 20.0);
        let first_pair = Pair::new(&dark, &dark).expect("one size");
        assert_eq!(temporal.push(&first_pair, Some(&first)), Ok(None));
        let pair = Pair::new(&light, &reference).expect("one size");
        temporal.push(&pair, Some(&second)).expect("one size")
    };
    let upper = change(rows(0, 10), rows(0, 20)).expect("a change");
    assert_eq!((upper.difference, upper.reference), (0.0, 10.0));
    let lower = change(rows(0, 20), rows(10, 20)).expect("a change");
    assert_eq!((lower.difference, lower.reference), (30.0, 10.0));
    assert_eq!(MIN_AREA_PX, 100);
    assert_eq!(change(rows(0, 10), rows(6, 20)), None, "80 px are too few");
}
