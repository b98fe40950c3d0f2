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
const SSIM: (f64, f64, &str) = (-1.0 - ROUNDING, 1.0 + ROUNDING, "-1 to 1");
const FLIP: (f64, f64, &str) = (0.0, 1.0 + ROUNDING, "0 to 1");

/// Declares metrics, a row each.
macro_rules! metrics {
    ($($label:literal, $column:expr, $range:expr, mean: $mean:literal, |$s:ident| $score:expr, |$v:ident| $text:expr;)*) => {
        [$(ImageMetric {
            label: $label,
            column: $column,
            range: $range,
            has_mean: $mean,
            score: |$s| $score,
            text: |$v| $text,
        }),*]
    };
}

/// Every image metric, in the order of tables. PSNR has no mean, as it is infinite where one frame is equal.
pub const METRICS: [ImageMetric; 9] = metrics! {
    "SSIM", Some("ssim"), SSIM, mean: true, |s| s.ssim, |v| format!("{v:.6}");
    "FLIP mean", Some("flip"), FLIP, mean: true, |s| Some(s.flip_mean), |v| format!("{v:.6}");
    "FLIP p95", Some("flip_p95"), FLIP, mean: false, |s| Some(s.flip_p95), |v| format!("{v:.6}");
    "FLIP p99", Some("flip_p99"), FLIP, mean: false, |s| Some(s.flip_p99), |v| format!("{v:.6}");
    "PSNR, dB", Some("psnr_db"), (0.0, f64::INFINITY, "0 or more, or inf"), mean: false, |s| Some(s.psnr_db), |v| format!("{v:.3}");
    "relMSE", Some("rel_mse"), ANY_SIZE, mean: true, |s| Some(s.rel_mse), |v| format!("{v:.4e}");
    "relMSE less top 0.1 %", None, ANY_SIZE, mean: true, |s| Some(s.rel_mse_trimmed), |v| format!("{v:.4e}");
    "largest difference /255", Some("max_difference"), (0.0, 255.0, "0 to 255"), mean: false, |s| Some(s.max_difference), |v| format!("{v:.2}");
    "specks, of a million pixels", Some("specks"), (0.0, 1.0 + ROUNDING, "0 to 1"), mean: true, |s| Some(s.specks), |v| format!("{:.0}", v * 1e6);
};

/// Metrics that are columns of samples, with the names of the columns.
pub fn columns() -> impl Iterator<Item = (&'static str, &'static ImageMetric)> {
    METRICS.iter().filter_map(|m| Some((m.column?, m)))
}
