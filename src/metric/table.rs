//! Table of image metrics: name, range, mean and format of each.

use super::Scores;

/// Tolerance past the ends of ranges, for rounded shares and SSIM.
pub const ROUNDING: f64 = 1e-6;

/// One metric of a pair of pictures over a region.
pub struct ImageMetric {
    /// Label in the table of `compare`.
    pub label: &'static str,
    /// Column of the samples, prefixed `mask_` for the mask's score; none where samples leave the metric out.
    pub column: Option<&'static str>,
    /// Least and most value that a cell can hold, and the name of the range in messages.
    pub range: (f64, f64, &'static str),
    /// Whether the mean over the frames of an animation makes sense.
    pub has_mean: bool,
    /// Function that takes the metric's score.
    pub score: fn(&Scores) -> Option<f64>,
    /// Function that formats a score.
    pub text: fn(f64) -> String,
}

const ANY_SIZE: (f64, f64, &str) = (0.0, f64::MAX, "a finite number, 0 or more");
const FLIP: (f64, f64, &str) = (0.0, 1.0 + ROUNDING, "0 to 1");

/// Every image metric, in the order of tables.
pub const METRICS: [ImageMetric; 9] = [
    ImageMetric {
        label: "SSIM",
        column: Some("ssim"),
        range: (-1.0 - ROUNDING, 1.0 + ROUNDING, "-1 to 1"),
        has_mean: true,
        score: |s| s.ssim,
        text: |v| format!("{v:.6}"),
    },
    ImageMetric {
        label: "FLIP mean",
        column: Some("flip"),
        range: FLIP,
        has_mean: true,
        score: |s| Some(s.flip_mean),
        text: |v| format!("{v:.6}"),
    },
    ImageMetric {
        label: "FLIP p95",
        column: Some("flip_p95"),
        range: FLIP,
        has_mean: false,
        score: |s| Some(s.flip_p95),
        text: |v| format!("{v:.6}"),
    },
    ImageMetric {
        label: "FLIP p99",
        column: Some("flip_p99"),
        range: FLIP,
        has_mean: false,
        score: |s| Some(s.flip_p99),
        text: |v| format!("{v:.6}"),
    },
    ImageMetric {
        label: "PSNR, dB",
        column: Some("psnr_db"),
        range: (0.0, f64::INFINITY, "0 or more, or inf"),
        has_mean: false, // infinite where one frame is equal
        score: |s| Some(s.psnr_db),
        text: |v| format!("{v:.3}"),
    },
    ImageMetric {
        label: "relMSE",
        column: Some("rel_mse"),
        range: ANY_SIZE,
        has_mean: true,
        score: |s| Some(s.rel_mse),
        text: |v| format!("{v:.4e}"),
    },
    ImageMetric {
        label: "relMSE less top 0.1 %",
        column: None,
        range: ANY_SIZE,
        has_mean: true,
        score: |s| Some(s.rel_mse_trimmed),
        text: |v| format!("{v:.4e}"),
    },
    ImageMetric {
        label: "largest difference /255",
        column: Some("max_difference"),
        range: (0.0, 255.0, "0 to 255"),
        has_mean: false,
        score: |s| Some(s.max_difference),
        text: |v| format!("{v:.2}"),
    },
    ImageMetric {
        label: "specks, of a million pixels",
        column: Some("specks"),
        range: (0.0, 1.0 + ROUNDING, "0 to 1"),
        has_mean: true,
        score: |s| Some(s.specks),
        text: |v| format!("{:.0}", v * 1e6),
    },
];

/// Metrics that are columns of samples, with the names of the columns.
pub fn columns() -> impl Iterator<Item = (&'static str, &'static ImageMetric)> {
    METRICS.iter().filter_map(|m| Some((m.column?, m)))
}
