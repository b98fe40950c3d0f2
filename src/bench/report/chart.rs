//! Chart of milliseconds against error as SVG: a curve per method, the Pareto front, every point.

use super::{
    canvas::{Canvas, said},
    findings::spots,
};
use crate::sample::curve::{self, series, series_names};
use crate::{
    pareto::{Spot, pareto_front},
    sample::Sample,
    summary::{Group, Metric, Point, digits, label},
};
use marks::{End, Labels, cross, legend, mark};
use plotters::{
    coord::{
        ranged1d::{AsRangedCoord, Ranged, ValueFormatter},
        types::RangedCoordf64,
    },
    prelude::*,
};

mod marks;

/// Quantity on the horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Time {
    /// Time of the whole frame.
    Frame,
    /// Time of the passes that find reflections.
    Reflection,
}

impl Time {
    /// 5th and 95th percentile of a point's time.
    fn spread(self, point: &Point) -> Option<[f64; 2]> {
        match self {
            Self::Frame => point.ms.p5_p95,
            Self::Reflection => point.reflection_ms?.p5_p95,
        }
    }
}

/// Quantities on the axes of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// Time on the horizontal axis.
    pub time: Time,
    /// Error on the vertical axis.
    pub metric: Metric,
}

/// Largest number of dots with their values written beside them; above it, only dots on the front have them.
const MAX_NAMED: usize = 24;

/// Limit of percentile bars: this factor above the slowest median, and below the fastest.
pub const BAR_REACH: f64 = 1.5;

/// Size of a chart, pixels.
const SIZE: (u32, u32) = (860, 500);

/// Color of a curve in charts.
pub fn color(name: &str) -> RGBColor {
    let [r, g, b] = curve::color(name);
    RGBColor(r, g, b)
}

/// One point of a group, ready to be drawn.
struct Dot<'a> {
    point: &'a Point,
    spot: Spot,
    /// 5th and 95th percentile of the time.
    spread: Option<[f64; 2]>,
    is_on_front: bool,
}

/// A setting without an error that can be drawn.
struct Failure {
    ms: f64,
    method: String,
    text: String,
}

/// Draws a group; none where fewer than two points have both quantities.
///
/// # Errors
/// Message of the drawing library.
pub fn draw(group: &Group, axes: Axes) -> Result<Option<String>, String> {
    let dots = dots(group, axes);
    if dots.len() < 2 {
        return Ok(None);
    }
    let medians = dots.iter().map(|dot| [dot.spot.ms; 2]);
    let [first, last] = medians.fold([f64::INFINITY, 0.0], widened);
    // One frame with a long delay must not squeeze the dots together: bars are cut off.
    let limits = [first / BAR_REACH, last * BAR_REACH];
    let bars = dots.iter().filter_map(|dot| dot.spread);
    let bars = bars.map(|ends| ends.map(|ms| ms.clamp(limits[0], limits[1])));
    let failures = failures(group, axes.time);
    let crosses = failures
        .iter()
        .map(|f| [f.ms.clamp(limits[0], limits[1]); 2]);
    let [fastest, slowest] = bars.chain(crosses).fold([first, last], widened);
    let [bottom, top] = error_range(&dots);
    let errors = (bottom..top).log_scale();
    // A logarithmic axis needs a decade to be readable.
    if slowest > 8.0 * fastest && fastest > 0.0 {
        let times = (fastest / 1.3..slowest * 1.5).log_scale();
        plot(group, axes, &dots, &failures, times, errors, bottom, limits)
    } else {
        let margin = (0.08 * (slowest - fastest)).max(0.02 * slowest).max(1e-6);
        let times: RangedCoordf64 = ((fastest - margin).max(0.0)..slowest + 2.0 * margin).into();
        plot(group, axes, &dots, &failures, times, errors, bottom, limits)
    }
    .map(Some)
}

/// Whether the chart has percentile bars.
pub fn has_bars(group: &Group, time: Time) -> bool {
    group.points.iter().any(|p| time.spread(p).is_some())
}

/// Settings that were timed but could not be scored: they have an x coordinate, but no y.
fn failures(group: &Group, time: Time) -> Vec<Failure> {
    let shared = |p: &Point| Some((p.sample.scale, p.ms.median - p.reflection_ms?.median));
    let of = |(sample, why): &(Sample, String)| {
        let mut common = group.points.iter().filter_map(shared);
        let common = common.find(|(scale, _)| *scale == sample.scale);
        let ms = match (time, sample.reflection_ms, common) {
            (Time::Reflection, reflection, _) => reflection,
            (Time::Frame, Some(reflection), Some((_, common))) => Some(reflection + common),
            (Time::Frame, ..) => sample.frame_ms,
        };
        Some(Failure {
            ms: ms?,
            method: series(sample).to_owned(),
            text: format!("{}: failed, {why}", label(sample)),
        })
    };
    group.failed.iter().filter_map(of).collect()
}

fn dots(group: &Group, axes: Axes) -> Vec<Dot<'_>> {
    let (mut spots, mut points) = spots(group, axes.metric);
    if axes.time == Time::Reflection {
        let timed = points.iter().zip(&spots).filter_map(|(point, spot)| {
            let ms = point.reflection_ms?.median;
            Some((Spot { ms, ..*spot }, *point))
        });
        (spots, points) = timed.unzip();
    }
    let on_front = pareto_front(&spots);
    let rows = points.into_iter().zip(spots).zip(on_front);
    rows.map(|((point, spot), is_on_front)| Dot {
        point,
        spot,
        spread: axes.time.spread(point),
        is_on_front,
    })
    .collect()
}

/// Whole decades around the errors that are not 0; errors of 0 are drawn at the bottom.
fn error_range(dots: &[Dot]) -> [f64; 2] {
    let errors = dots.iter().map(|dot| dot.spot.error);
    let positive = errors.filter(|e| *e > 0.0 && e.is_finite());
    let (low, high) = positive.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), e| {
        (low.min(e), high.max(e))
    });
    if low > high {
        return [1e-6, 1.0];
    }
    let bottom = 10f64.powf((low * 0.9).log10().floor()).max(1e-9);
    [bottom, 10f64.powf((high * 1.1).log10().ceil())]
}

/// Smallest range that contains both.
fn widened([low, high]: [f64; 2], [first, last]: [f64; 2]) -> [f64; 2] {
    [low.min(first), high.max(last)]
}

fn plot<X, Y>(
    group: &Group,
    axes: Axes,
    dots: &[Dot],
    failures: &[Failure],
    times: impl AsRangedCoord<CoordDescType = X, Value = f64>,
    errors: impl AsRangedCoord<CoordDescType = Y, Value = f64>,
    bottom: f64,
    limits: [f64; 2],
) -> Result<String, String>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let canvas = Canvas {
        size: SIZE,
        above: 14,
        right: 14,
        titles: [x_title(group, axes.time), &y_title(group, axes.metric)],
        grid: [238, 214],
        x_label: &|ms| digits(*ms),
    };
    canvas.svg(times, errors, |chart| {
        let mut overlay = String::new();
        let shown = |spot: &Spot| (spot.ms, spot.error.max(bottom));
        let stairs = LineSeries::new(
            stairs(dots, bottom),
            RGBColor(150, 150, 150).stroke_width(6),
        );
        chart.draw_series(stairs).map_err(said)?;
        for method in series_names() {
            let curve = dots.iter().filter(|d| series(&d.point.sample) == method);
            let curve: Vec<(f64, f64)> = curve.map(|d| shown(&d.spot)).collect();
            let line = LineSeries::new(curve, color(method).stroke_width(2));
            chart.draw_series(line).map_err(said)?;
        }
        let to_pixels = chart.as_coord_spec();
        let few = dots.len() <= MAX_NAMED;
        let places: Vec<(i32, i32)> = dots
            .iter()
            .map(|dot| to_pixels.translate(&shown(&dot.spot)))
            .collect();
        let mut labels = Labels::around(&places);
        for (dot, at) in dots.iter().zip(places) {
            let end = |ms: f64| {
                let kept = ms.clamp(limits[0], limits[1]);
                let x = to_pixels.translate(&(kept, shown(&dot.spot).1)).0;
                let is_cut = kept != ms;
                End { x, is_cut }
            };
            let ends = dot.spread.map(|ends| ends.map(end));
            mark(&mut overlay, dot, group, axes.metric, at, ends);
            // The hover text has all values.
            if let (Some(value), true) = (dot.point.sample.value, few || dot.is_on_front) {
                labels.write(&mut overlay, value, at);
            }
        }
        legend(&mut overlay, dots, !failures.is_empty());
        for failure in failures {
            let ms = failure.ms.clamp(limits[0], limits[1]);
            let x = to_pixels.translate(&(ms, bottom)).0;
            cross(&mut overlay, failure, x);
        }
        Ok(overlay)
    })
}

fn x_title(group: &Group, time: Time) -> &'static str {
    let timed = group.points.iter().all(|p| p.reflection_ms.is_some());
    match (time, timed) {
        (Time::Reflection, _) => "milliseconds of march, trace and blur",
        (Time::Frame, true) => "milliseconds a frame (passes that all share: one median)",
        (Time::Frame, false) => "milliseconds a frame (wall time)",
    }
}

fn y_title(group: &Group, metric: Metric) -> String {
    let region = if group.masked {
        "in reflections"
    } else {
        "whole frame"
    };
    format!("{}, {region}", metric.name())
}

/// Pareto front as a staircase: the least error that is reached within every time.
fn stairs(dots: &[Dot], bottom: f64) -> Vec<(f64, f64)> {
    let mut on_front: Vec<Spot> = dots
        .iter()
        .filter(|d| d.is_on_front)
        .map(|d| d.spot)
        .collect();
    on_front.sort_by(|a, b| a.ms.total_cmp(&b.ms));
    let mut stairs: Vec<(f64, f64)> = Vec::new();
    for spot in on_front {
        let error = spot.error.max(bottom);
        if let Some(&(_, before)) = stairs.last() {
            stairs.push((spot.ms, before));
        }
        stairs.push((spot.ms, error));
    }
    stairs
}

/// Escapes text for XML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
