//! Samples → points: medians and spreads of repeated frames, grouped by charts.

use reflet_render::pipeline::pass::Pass;

use super::sample::Sample;
use reflet_metric::{percentile, table};
use reflet_scene::words;

mod group;
pub mod paired;
mod pairs;

pub use group::groups;
use paired::Timed;
pub use pairs::{FlickerRatio, Split};

/// Smallest number of repetitions with percentiles.
pub const MIN_SPREAD_N: usize = 20;

/// Repeated measurements of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Number of measurements.
    pub n: usize,
    /// Median of the measurements.
    pub median: f64,
    /// 5th and 95th percentile; none below [`MIN_SPREAD_N`].
    pub p5_p95: Option<[f64; 2]>,
}

/// One setting of one method, with the statistics of its frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// First sample of the setting, for settings, errors and shares.
    pub sample: Sample,
    /// Milliseconds per frame. Where passes are timed: its own reflection passes, plus the group's median
    /// of all other passes, which every method shares; otherwise wall time.
    pub ms: Spread,
    /// Wall time per frame, milliseconds.
    pub frame_ms: Spread,
    /// Milliseconds of the passes that find reflections, where they are timed.
    pub reflection_ms: Option<Spread>,
    /// Median milliseconds of each pass that ran.
    pub passes_ms: Vec<(String, f64)>,
    /// Whether errors, shares, false accepts and rejects and counts are means over the frames of an animation.
    pub is_mean: bool,
    /// Flicker ratio of the animation, against the reference.
    pub flicker: Option<FlickerRatio>,
    /// Trace pass split into traversal and shading, where they were timed apart.
    pub split: Option<Split>,
    /// Time of each timed frame.
    pub timed: Vec<Timed>,
}

/// Points that may share a chart: one scene and content, camera, size, reference, adapter, commit
/// and one choice of the varied parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Points in the order of the table.
    pub points: Vec<Point>,
    /// Settings that could not be scored or timed, with the reason.
    pub failed: Vec<(Sample, String)>,
    /// Whether errors are measured inside the mask, because the mask is large enough in all points.
    pub masked: bool,
    /// Frame number and point of every frame of an animation, whose `points` are means over the measured
    /// frames. Empty for a still scene.
    pub over_frames: Vec<(u32, Point)>,
    /// Frames of an animation that were left out because some setting lacks them.
    pub left_out: Vec<u32>,
}

words! {
    /// Error metric; its word stands on axes and in sentences.
    pub enum Metric {
        /// Mean FLIP.
        Flip = "FLIP",
        /// 1 − SSIM.
        Dissimilarity = "1 − SSIM",
        /// relMSE.
        RelMse = "relMSE",
    }
}

impl Spread {
    /// Statistics of some values; none for an empty list.
    pub fn from_values(mut values: Vec<f64>) -> Option<Self> {
        if values.is_empty() || values.iter().any(|v| v.is_nan()) {
            return None;
        }
        Some(Self {
            n: values.len(),
            median: percentile(&mut values, 0.5),
            p5_p95: (values.len() >= MIN_SPREAD_N)
                .then(|| [0.05, 0.95].map(|p| percentile(&mut values, p))),
        })
    }

    /// Text such as `4.21 ms (4.10 to 4.63)`, or with n where that is too small for percentiles.
    pub fn text(&self) -> String {
        let median = digits(self.median);
        match self.p5_p95 {
            Some([low, high]) => format!("{median} ({} to {})", digits(low), digits(high)),
            None => format!("{median} (n = {})", self.n),
        }
    }
}

/// A number with three significant digits, for people.
pub fn digits(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    if !(1e-3..1e6).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let decimals = (2 - magnitude.log10().floor() as i32).max(0);
    format!("{value:.*}", decimals as usize)
}

impl Point {
    fn new(samples: &[&Sample]) -> Option<Self> {
        let spread = |of: fn(&Sample) -> Option<f64>| {
            let values: Option<Vec<f64>> = samples.iter().map(|s| of(s)).collect();
            values.and_then(Spread::from_values)
        };
        let frame_ms = spread(|s| s.frame_ms)?;
        let first = samples.first()?;
        let passes = first.details("pass_", "_ms").into_iter().enumerate();
        let median = |(index, (name, _)): (usize, (String, f64))| {
            let of = |s: &&Sample| s.details("pass_", "_ms")[index].1;
            let spread = Spread::from_values(samples.iter().map(of).collect())?;
            (spread.median > 0.0).then_some((name, spread.median))
        };
        let reflection_ms = spread(|s| s.reflection_ms);
        let own = |s: &Sample| reflection_ms.map_or(s.frame_ms, |_| s.reflection_ms);
        let timed = samples
            .iter()
            .filter_map(|s| Some(Timed::from_sample(s, own(s)?)));
        Some(Self {
            ms: frame_ms,
            frame_ms,
            reflection_ms,
            timed: timed.collect(),
            passes_ms: passes.filter_map(median).collect(),
            is_mean: false,
            flicker: None,
            split: Split::from_samples(samples),
            sample: (*first).clone(),
        })
    }

    /// Point of an animation: errors and shares are means over its frames, errors inside the
    /// mask over the frames whose mask is large enough; shares are of all reflective pixels.
    /// Metrics without a mean are left out.
    fn averaged(mut self, samples: &[&Sample]) -> Self {
        self.is_mean = true;
        // Times of different frames spread by content, not by noise alone.
        let spreads = [Some(&mut self.ms), Some(&mut self.frame_ms)].into_iter();
        for spread in spreads.chain([self.reflection_ms.as_mut()]).flatten() {
            spread.p5_p95 = None;
        }
        let mean = |of: &dyn Fn(&Sample) -> Option<f64>| {
            let values: Vec<f64> = samples.iter().filter_map(|s| of(s)).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        let s = &mut self.sample;
        for (name, metric) in table::columns() {
            for column in [name.to_owned(), format!("mask_{name}")] {
                let value = mean(&|s| *s.number(&column)?).filter(|_| metric.has_mean);
                *s.number_mut(&column).expect("every metric is a column") = value;
            }
        }
        s.mask_px = mean(&|s| Some(s.mask_px as f64)).unwrap_or(0.0) as u64;
        s.rays = mean(&|s| Some(s.rays as f64)).unwrap_or(0.0) as u64;
        s.update_ms = mean(&|s| s.update_ms);
        let reflective: f64 = samples.iter().map(|s| s.reflective_px as f64).sum();
        let share = |of: fn(&Sample) -> f64| {
            let sum: f64 = samples.iter().map(|s| of(s) * s.reflective_px as f64).sum();
            sum / reflective.max(1.0)
        };
        s.screen_percent = share(|s| s.screen_percent);
        s.traced_percent = share(|s| s.traced_percent);
        s.probe_percent = Some(share(|s| s.probe_percent.unwrap_or(0.0)));
        s.failed_percent = share(|s| s.failed_percent);
        s.none_percent = share(|s| s.none_percent);
        s.rough_percent = share(|s| s.rough_percent);
        let mean_count = |of: fn(&Sample) -> Option<u64>| {
            let counts: Option<Vec<u64>> = samples.iter().map(|s| of(s)).collect();
            counts.map(|counts| {
                let n = counts.len() as u64;
                (counts.iter().sum::<u64>() + n / 2) / n
            })
        };
        (s.false_accepts, s.false_rejects) = (
            mean_count(|s| s.false_accepts),
            mean_count(|s| s.false_rejects),
        );
        s.march_steps = mean_count(|s| s.march_steps);
        s.traversals = mean_count(|s| s.traversals);
        s.visited_nodes = mean_count(|s| s.visited_nodes);
        s.tested_triangles = mean_count(|s| s.tested_triangles);
        // Times of passes have medians of their own; causes, false accepts and rejects and counts have means.
        for (index, value) in s.detail.iter_mut().enumerate() {
            let sum: f64 = samples.iter().map(|s| s.detail[index]).sum();
            *value = sum / samples.len() as f64;
        }
        self
    }

    /// Error inside the mask or over the frame.
    pub fn error(&self, metric: Metric, masked: bool) -> Option<f64> {
        let s = &self.sample;
        let [flip, ssim, rel_mse] = if masked {
            [s.mask_flip, s.mask_ssim, s.mask_rel_mse]
        } else {
            [s.flip, s.ssim, s.rel_mse]
        };
        match metric {
            Metric::Flip => flip,
            // Rounding can put equal pictures a little over 1.
            Metric::Dissimilarity => ssim.map(|ssim| (1.0 - ssim).max(0.0)),
            Metric::RelMse => rel_mse,
        }
    }

    /// Milliseconds of a pass; 0 where it did not run.
    pub fn pass_ms(&self, pass: &Pass) -> f64 {
        let found = self.passes_ms.iter().find(|(name, _)| name == pass.name);
        found.map_or(0.0, |(_, ms)| *ms)
    }

    /// Name for people, such as `hybrid, threshold_u = 0.025`.
    pub fn label(&self) -> String {
        label(&self.sample)
    }
}

/// Name of a sample's setting, for people.
pub fn label(sample: &Sample) -> String {
    match (&sample.parameter, sample.value) {
        (Some(parameter), Some(value)) => format!("{}, {parameter} = {value}", sample.method),
        _ => sample.method.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_need_twenty_values() {
        let ramp = |n: usize| (0..n).map(|i| i as f64).collect::<Vec<_>>();
        let few = Spread::from_values(ramp(19)).expect("values");
        assert_eq!((few.n, few.median, few.p5_p95), (19, 9.0, None));
        assert!(few.text().ends_with("(n = 19)"));
        let many = Spread::from_values(ramp(21)).expect("values");
        assert_eq!(many.p5_p95, Some([1.0, 19.0]));
        assert_eq!(
            Spread::from_values(vec![1.0, 2.0]).expect("values").median,
            1.5
        );
        assert_eq!(Spread::from_values(Vec::new()), None);
    }

    #[test]
    fn numbers_keep_three_digits() {
        let of = [0.0, 0.012345, 1.2345, 12.345, 123.45, 1234.5, 1.5e-5];
        let texts = of.map(digits);
        let expected = ["0", "0.0123", "1.23", "12.3", "123", "1234", "1.50e-5"];
        assert_eq!(texts, expected);
    }
}
