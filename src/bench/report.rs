//! Report of a table of samples: sentences, charts and tables, as one page and as SVG files. Draws
//! only from the table and measures nothing.

pub mod canvas;
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
use reflet_scene::declared::Words as _;

/// A chart as a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChartFile {
    /// Name of the file.
    pub name: String,
    /// Contents as SVG.
    pub svg: String,
    /// Caption that explains how to read the chart.
    pub caption: String,
}

/// One group with its sentences and charts.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Group of comparable points.
    pub group: Group,
    /// Findings on the points, a sentence each.
    pub sentences: Vec<String>,
    /// Charts of the group: time against error, and line charts.
    pub charts: Vec<ChartFile>,
}

impl Section {
    /// First sample of the group, for the values that all samples share.
    fn sample(&self) -> Option<&Sample> {
        let points = self.group.points.iter().map(|p| &p.sample);
        let failed = self.group.failed.iter().map(|(sample, _)| sample);
        points.chain(failed).next()
    }

    /// Heading with scene, camera, size and varied parameter.
    pub fn heading(&self) -> String {
        self.sample().map_or(String::new(), page::heading)
    }
}

/// Sections of all samples.
///
/// # Errors
/// Message when a chart cannot be drawn.
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
            for (chart, word) in LineChart::ALL.into_iter().zip(LineChart::WORDS) {
                if let Some(svg) = line_chart::draw(&group, chart)? {
                    charts.push(ChartFile {
                        name: format!("line-chart-{}-{}.svg", index + 1, word.name),
                        svg,
                        caption: word.summary.to_owned(),
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

/// Caption of a chart of error against time.
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
         every curve a method over its varied parameter; the gray stairs are the Pareto front.{bars} An \
         error of 0 stands on the bottom edge.{crosses}"
    )
}
