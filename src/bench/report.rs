//! The report of a table of samples: sentences, charts and tables, as one page and as SVG files.
//! Everything is drawn from the table; nothing is measured here.

pub mod chart;
pub mod findings;
pub mod line_chart;
pub mod page;
pub mod tables;
pub mod work;

use super::sample::Sample;
use super::summary::{Group, Metric, groups};
use chart::{Axes, BAR_REACH, Time, draw, has_bars};
use line_chart::LineChart;

/// A chart as a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChartFile {
    /// Name of the file.
    pub name: String,
    /// Its SVG.
    pub svg: String,
    /// How to read it.
    pub caption: String,
}

/// One group with everything that is said and drawn about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The points.
    pub group: Group,
    /// What they mean, a sentence each.
    pub sentences: Vec<String>,
    /// Time against error.
    pub charts: Vec<ChartFile>,
}

impl Section {
    /// One of its samples, for what all have in common.
    fn sample(&self) -> Option<&Sample> {
        let points = self.group.points.iter().map(|p| &p.sample);
        let failed = self.group.failed.iter().map(|(sample, _)| sample);
        points.chain(failed).next()
    }

    /// Scene, camera, size and what was turned.
    pub fn heading(&self) -> String {
        self.sample().map_or(String::new(), page::heading)
    }
}

/// Sections of all samples.
///
/// # Errors
/// A sentence when a chart cannot be drawn.
pub fn sections(samples: &[Sample]) -> Result<Vec<Section>, String> {
    let groups = groups(samples).into_iter().enumerate();
    groups
        .map(|(index, group)| {
            let mut charts = Vec::new();
            let is_turned = group.points.iter().any(|p| p.sample.value.is_some());
            for (what, time, metric) in [
                ("flip", Time::Frame, Metric::Flip),
                ("ssim", Time::Frame, Metric::Dissimilarity),
                ("reflection", Time::Reflection, Metric::Flip),
            ] {
                if !is_turned {
                    break; // single points are a table, not a chart
                }
                let axes = Axes { time, metric };
                if let Some(svg) = draw(&group, axes)? {
                    charts.push(ChartFile {
                        name: format!("chart-{}-{what}.svg", index + 1),
                        svg,
                        caption: caption(&group, axes),
                    });
                }
            }
            for (what, chart) in [
                ("parameter", LineChart::ErrorByParameter),
                ("ms", LineChart::Milliseconds),
                ("ssim", LineChart::Ssim),
                ("flicker", LineChart::Flicker),
            ] {
                if let Some(svg) = line_chart::draw(&group, chart)? {
                    charts.push(ChartFile {
                        name: format!("line-chart-{}-{what}.svg", index + 1),
                        svg,
                        caption: chart.caption().to_owned(),
                    });
                }
            }
            Ok(Section {
                sentences: findings::sentences(&group),
                charts,
                group,
            })
        })
        .collect()
}

/// How a chart of error against time is read.
fn caption(group: &Group, axes: Axes) -> String {
    let what = match axes.time {
        Time::Frame => "time of a frame",
        Time::Reflection => "time of the passes that find reflections",
    };
    let error = match axes.metric {
        Metric::Flip => "FLIP, the difference an observer sees: 0 is equal, 1 is black for white",
        Metric::Dissimilarity => "1 − SSIM: 0 is equal",
        Metric::RelMse => "relMSE: 0 is equal",
    };
    let bars = if has_bars(group, axes.time) {
        format!(
            " Bars are the 5th to 95th percentile, cut off at {BAR_REACH} times the slowest median."
        )
    } else {
        String::new()
    };
    let crosses = if group.failed.is_empty() {
        ""
    } else {
        " A cross on the upper edge is a setting that could not be judged."
    };
    format!(
        "Across: {what}; up: {error}. Lower left is better. Every dot is a setting (point at it), \
         every curve a method turned by its parameter; the gray stairs are what nothing beats.{bars} An \
         error of 0 stands on the bottom edge.{crosses}"
    )
}
