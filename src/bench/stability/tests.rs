//! Tests of the scores of failure modes.

use super::*;

fn part(frames: u32) -> Part {
    Part {
        against: ReferenceKind::Rt,
        scene: "a.toml".to_owned(),
        content: "7".to_owned(),
        size: [32, 18],
        frames: (0..frames).collect(),
    }
}

fn sample(frame: u32, flip: Option<f64>) -> Sample {
    Sample {
        scene: "a.toml".to_owned(),
        content: "7".to_owned(),
        turn: "rules".to_owned(),
        method: "hybrid".to_owned(),
        accept: "verified".to_owned(),
        frame,
        width: 32,
        height: 18,
        status: "ok".to_owned(),
        reflective_px: 500,
        mask_px: if flip.is_some() { 200 } else { 12 },
        mask_flip: flip,
        mask_flip_p99: flip.map(|f| 2.0 * f),
        mask_rel_mse: flip,
        false_accepts: Some(5),
        since_frame: frame.checked_sub(1),
        mask_temporal_difference: Some(3.0).filter(|_| frame > 0),
        mask_temporal_change: Some(6.0).filter(|_| frame > 0),
        ..Sample::default()
    }
}

fn scores_of(frames: u32, samples: &[Sample]) -> Result<CellScores, String> {
    scores(&[&part(frames)], "hybrid", samples)
}

#[test]
fn a_film_is_scored_by_its_means_and_its_worst_frame() {
    let samples = [
        sample(0, Some(0.1)),
        sample(1, Some(0.3)),
        sample(2, Some(0.2)),
    ];
    let s = scores_of(3, &samples).expect("scores");
    assert!((s.flip - 0.2).abs() < 1e-12);
    assert_eq!(
        (s.flip_p99, s.worst.to_string().as_str()),
        (0.6, "frame 1, 32 x 18")
    );
    assert_eq!(
        (s.false_accepts_px, s.false_accepts_permille),
        (Some(15), Some(10.0))
    );
    assert_eq!((s.flicker, s.popping, s.ssim), (Some(0.5), Some(0.5), None));
    assert_eq!(
        scores_of(1, &samples).expect("scores").flicker,
        None,
        "a still"
    );
}

#[test]
fn one_frame_without_a_score_leaves_the_cell_without_one() {
    let says = |samples: &[Sample]| scores_of(2, samples).expect_err("no score");
    let first = sample(0, Some(0.1));
    assert_eq!(
        says(std::slice::from_ref(&first)),
        "frame 1, 32 x 18: not measured"
    );
    let empty = says(&[first.clone(), sample(1, None)]);
    assert!(empty.contains("frame 1, 32 x 18: 12 px inside"), "{empty}");
    let mut failed = sample(1, Some(0.1));
    failed.status = "pixel 3 is NaN".to_owned();
    assert_eq!(says(&[first, failed]), "frame 1, 32 x 18: pixel 3 is NaN");
}

#[test]
fn the_newest_sample_of_the_same_content_counts() {
    let mut other = sample(0, Some(0.9));
    other.content = "8".to_owned();
    let mut threshold = sample(0, Some(0.8));
    threshold.accept = "threshold".to_owned();
    let samples = [sample(0, Some(0.5)), sample(0, Some(0.1)), other, threshold];
    assert_eq!(scores_of(1, &samples).expect("scores").flip, 0.1);
}

#[test]
fn every_row_has_all_columns() {
    let cell = |scores| Cell {
        mode: "03-rails".to_owned(),
        method: "ssr".to_owned(),
        against: ReferenceKind::Truth,
        scores,
    };
    let cells = [
        cell(scores_of(1, &[sample(0, Some(0.1))])),
        cell(Err("a, b".to_owned())),
    ];
    let table = csv::parse(&table(&cells, "a chip")).expect("a table");
    assert_eq!(
        table.columns.len(),
        OF_CELL.len() + CellScores::COLUMNS.len() + SAID.len()
    );
    assert_eq!(table.rows[1].last().map(String::as_str), Some("a, b"));
    assert_eq!(table.rows[0][2], "truth");
}
