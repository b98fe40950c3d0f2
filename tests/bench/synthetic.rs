//! Synthetic samples with known Pareto front and break-even.

use reflet::bench::{sample::detail_columns, summary::Group};

use super::*;

/// A synthetic sample: method, parameter value, milliseconds, FLIP; SSIM is 1 − FLIP.
pub fn sample(method: &str, value: f64, ms: f64, flip: f64) -> Sample {
    Sample {
        fingerprint: format!("{method}-{value}"),
        scene: "made up".to_owned(),
        camera: "main".to_owned(),
        width: 640,
        height: 360,
        content: "c0ffee".to_owned(),
        method: method.to_owned(),
        turn: "steps".to_owned(),
        parameter: Some("steps".to_owned()),
        value: Some(value),
        threshold_u: 0.025,
        steps: value as u32,
        ray_length_u: 16.0,
        bounces: 3,
        scale: 1.0,
        status: "ok".to_owned(),
        frame_ms: Some(ms + 1.0),
        passes_ms: Some(ms),
        reflection_ms: Some(ms - 3.0),
        mask_px: 1000,
        mask_flip: Some(flip),
        mask_ssim: Some(1.0 - flip),
        flip: Some(flip / 10.0),
        ssim: Some(1.0 - flip / 10.0),
        adapter: "made-up adapter".to_owned(),
        reference_bounces: 16,
        detail: vec![0.0; detail_columns().len()],
        ..Sample::default()
    }
}

fn set(sample: &mut Sample, column: &str, value: f64) {
    let index = detail_columns().iter().position(|name| name == column);
    sample.detail[index.expect("a column")] = value;
}

/// ssr is fast and wrong, hybrid between, rt exact; one hybrid setting is dominated.
pub fn synthetic_samples() -> Vec<Sample> {
    let mut rows = vec![
        sample("ssr", 16.0, 5.0, 0.4),
        sample("ssr", 128.0, 6.0, 0.3),
        sample("hybrid", 16.0, 8.0, 0.05),
        sample("hybrid", 128.0, 9.0, 0.01),
        sample("hybrid", 256.0, 12.0, 0.02),
        sample("rt", 3.0, 10.0, 0.001),
    ];
    for row in &mut rows[2..5] {
        row.rays = 250;
        set(row, "pass_ssr_ms", 1.5);
        set(row, "pass_trace_ms", 1.0);
    }
    rows[5].rays = 1000;
    set(&mut rows[5], "pass_ssr_ms", 0.5);
    set(&mut rows[5], "pass_trace_ms", 3.0);
    rows
}

/// Repetitions of the same samples.
pub fn repeated(rows: &[Sample], times: u32) -> Vec<Sample> {
    let again = |repetition| {
        rows.iter().map(move |row| Sample {
            repetition,
            ..row.clone()
        })
    };
    (0..times).flat_map(again).collect()
}

/// The only group of the samples.
pub fn only_group(samples: &[Sample]) -> Group {
    let mut groups = groups(samples);
    assert_eq!(groups.len(), 1);
    groups.remove(0)
}
