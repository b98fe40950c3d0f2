//! Milliseconds against error as SVG: a curve per method, the Pareto front, every point.

use std::fmt::Write as _;

use plotters::{
    coord::{
        ranged1d::{AsRangedCoord, Ranged, ValueFormatter},
        types::RangedCoordf64,
    },
    prelude::*,
};

use super::words::spots;
use crate::bench::{
    front::{Spot, front},
    summary::{Group, Metric, Point, digits},
};

/// What the horizontal axis shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Time {
    /// The whole frame.
    Frame,
    /// The passes that find reflections.
    Reflection,
}

/// What is drawn against what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// Across.
    pub time: Time,
    /// Up.
    pub metric: Metric,
}

/// Most dots whose values are written beside them; of more, only those on the front.
const MAX_NAMED: usize = 24;

/// Pixels of a chart.
const SIZE: (u32, u32) = (860, 500);

/// Colors that stay apart for color-blind readers (Okabe and Ito 2008).
pub fn color(method: &str) -> RGBColor {
    match method {
        "ssr" => RGBColor(0, 114, 178),
        "hybrid" => RGBColor(213, 94, 0),
        _ => RGBColor(0, 158, 115),
    }
}

/// One point ready to be drawn.
struct Dot<'a> {
    point: &'a Point,
    spot: Spot,
    /// 5th and 95th percentile of the time.
    spread: Option<[f64; 2]>,
    is_on_front: bool,
}

/// Draws a group; none where fewer than two points have both quantities.
///
/// # Errors
/// What the drawing library says.
pub fn draw(group: &Group, axes: Axes) -> Result<Option<String>, String> {
    let dots = dots(group, axes);
    if dots.len() < 2 {
        return Ok(None);
    }
    let times = dots.iter().flat_map(|dot| {
        let [low, high] = dot.spread.unwrap_or([dot.spot.ms; 2]);
        [low, high, dot.spot.ms]
    });
    let (fastest, slowest) = times.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), ms| {
        (low.min(ms), high.max(ms))
    });
    let [bottom, top] = error_range(&dots);
    let errors = (bottom..top).log_scale();
    // A log axis needs a decade to be readable.
    if slowest > 8.0 * fastest && fastest > 0.0 {
        let times = (fastest / 1.3..slowest * 1.5).log_scale();
        plot(group, axes, &dots, times, errors, bottom)
    } else {
        let margin = (0.08 * (slowest - fastest)).max(0.02 * slowest).max(1e-6);
        let times: RangedCoordf64 = ((fastest - margin).max(0.0)..slowest + 2.0 * margin).into();
        plot(group, axes, &dots, times, errors, bottom)
    }
    .map(Some)
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
    let on_front = front(&spots);
    let rows = points.into_iter().zip(spots).zip(on_front);
    rows.map(|((point, spot), is_on_front)| Dot {
        point,
        spot,
        spread: match axes.time {
            Time::Frame => point.ms.p5_p95,
            Time::Reflection => point.reflection_ms.and_then(|s| s.p5_p95),
        },
        is_on_front,
    })
    .collect()
}

/// Whole decades around the errors that are not 0; those stand at the bottom.
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

/// What plotters says, as text.
fn said(error: impl std::fmt::Display) -> String {
    format!("the chart cannot be drawn: {error}")
}

fn plot<X, Y>(
    group: &Group,
    axes: Axes,
    dots: &[Dot],
    times: impl AsRangedCoord<CoordDescType = X, Value = f64>,
    errors: impl AsRangedCoord<CoordDescType = Y, Value = f64>,
    bottom: f64,
) -> Result<String, String>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut svg = String::new();
    let mut overlay = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(said)?;
        let mut chart = ChartBuilder::on(&root)
            .margin(14)
            .x_label_area_size(44)
            .y_label_area_size(74)
            .build_cartesian_2d(times, errors)
            .map_err(said)?;
        chart
            .configure_mesh()
            .x_desc(x_title(group, axes.time))
            .y_desc(y_title(group, axes.metric))
            .x_label_formatter(&|ms| digits(*ms))
            .y_label_formatter(&|error| digits(*error))
            .light_line_style(RGBColor(238, 238, 238))
            .bold_line_style(RGBColor(214, 214, 214))
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .draw()
            .map_err(said)?;
        let shown = |spot: &Spot| (spot.ms, spot.error.max(bottom));
        let stairs = LineSeries::new(
            stairs(dots, bottom),
            RGBColor(150, 150, 150).stroke_width(6),
        );
        chart.draw_series(stairs).map_err(said)?;
        for method in ["ssr", "hybrid", "rt"] {
            let curve = dots.iter().filter(|d| d.point.sample.method == method);
            let curve: Vec<(f64, f64)> = curve.map(|d| shown(&d.spot)).collect();
            let line = LineSeries::new(curve, color(method).stroke_width(2));
            chart.draw_series(line).map_err(said)?;
        }
        let to_pixels = chart.as_coord_spec();
        let few = dots.len() <= MAX_NAMED;
        for dot in dots {
            let at = to_pixels.translate(&shown(&dot.spot));
            let ends = dot
                .spread
                .map(|ends| ends.map(|ms| to_pixels.translate(&(ms, shown(&dot.spot).1)).0));
            mark(&mut overlay, dot, group, axes.metric, at, ends);
            // Many labels cover each other; the hover text has all of them.
            if let (Some(value), true) = (dot.point.sample.value, few || dot.is_on_front) {
                name(&mut overlay, value, at);
            }
        }
        legend(&mut overlay, dots);
        root.present().map_err(said)?;
    }
    let end = svg.rfind("</svg>").ok_or_else(|| said("it has no end"))?;
    svg.insert_str(end, &overlay);
    Ok(svg)
}

fn x_title(group: &Group, time: Time) -> String {
    let timed = group.points.iter().all(|p| p.reflection_ms.is_some());
    match (time, timed) {
        (Time::Reflection, _) => "milliseconds of march, compaction, trace and blur",
        (Time::Frame, true) => "milliseconds a frame (passes that all share: one median)",
        (Time::Frame, false) => "milliseconds a frame (wall time)",
    }
    .to_owned()
}

fn y_title(group: &Group, metric: Metric) -> String {
    let region = if group.masked {
        "in reflections"
    } else {
        "whole frame"
    };
    format!("{}, {region}", metric.name())
}

/// The front as stairs: what is reached at every time.
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

/// A dot with its hover text; hollow when dominated, ringed on the front.
fn mark(
    out: &mut String,
    dot: &Dot,
    group: &Group,
    metric: Metric,
    (x, y): (i32, i32),
    ends: Option<[i32; 2]>,
) {
    let RGBColor(r, g, b) = color(&dot.point.sample.method);
    let title = format!(
        "{}: {} ms, {} {}{}{}",
        dot.point.label(),
        digits(dot.spot.ms),
        metric.name(),
        digits(dot.spot.error),
        dot.point
            .error(Metric::Dissimilarity, group.masked)
            .map_or(String::new(), |e| format!(", SSIM {:.4}", 1.0 - e)),
        if dot.is_on_front {
            ", on the front"
        } else {
            ", dominated"
        }
    );
    let (fill, ring) = if dot.is_on_front {
        (format!("rgb({r},{g},{b})"), "#111")
    } else {
        ("#fff".to_owned(), "")
    };
    let stroke = if ring.is_empty() {
        format!("rgb({r},{g},{b})")
    } else {
        ring.to_owned()
    };
    // Writing to a string cannot fail.
    if let Some([low, high]) = ends {
        let _ = writeln!(
            out,
            "<path d=\"M{low} {y}H{high}M{low} {}v8M{high} {}v8\" stroke=\"rgb({r},{g},{b})\" \
             stroke-opacity=\".55\"/>",
            y - 4,
            y - 4
        );
    }
    let _ = writeln!(
        out,
        "<circle cx=\"{x}\" cy=\"{y}\" r=\"6\" fill=\"{fill}\" stroke=\"{stroke}\" \
         stroke-width=\"2\"><title>{}</title></circle>",
        escape(&title)
    );
}

/// A knob's value beside its dot.
fn name(out: &mut String, value: f64, (x, y): (i32, i32)) {
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"11\" \
         fill=\"#444\">{value}</text>",
        x + 9,
        y - 7
    );
}

/// Methods with their knob, and what the marks mean, in the upper right corner.
fn legend(out: &mut String, dots: &[Dot]) {
    let mut lines: Vec<(String, String, &str)> = Vec::new();
    for method in ["ssr", "hybrid", "rt"] {
        let of = dots.iter().filter(|d| d.point.sample.method == method);
        let knobs: Vec<&str> = of
            .clone()
            .filter_map(|d| d.point.sample.knob.as_deref())
            .collect();
        let turned = of.clone().any(|d| d.point.sample.value.is_some());
        let RGBColor(r, g, b) = color(method);
        if of.count() > 0 {
            let knob = knobs.first().filter(|_| turned);
            let text = knob.map_or(method.to_owned(), |knob| format!("{method}, by {knob}"));
            lines.push((text, format!("rgb({r},{g},{b})"), "2"));
        }
    }
    lines.push(("Pareto front".to_owned(), "#969696".to_owned(), "6"));
    let left = SIZE.0 as i32 - 214;
    let height = 20 * (lines.len() as i32 + 1) + 8;
    let _ = writeln!(
        out,
        "<rect x=\"{left}\" y=\"22\" width=\"190\" height=\"{height}\" fill=\"#fff\" \
         fill-opacity=\".88\" stroke=\"#ccc\"/>"
    );
    for (row, (text, stroke, width)) in lines.iter().enumerate() {
        let y = 38 + 20 * row as i32;
        let _ = writeln!(
            out,
            "<path d=\"M{} {y}h22\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>\
             <text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"12\">{}</text>",
            left + 8,
            left + 38,
            y + 4,
            escape(text)
        );
    }
    let y = 42 + 20 * lines.len() as i32;
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"11\" \
         fill=\"#444\">hollow: dominated; bottom: 0</text>",
        left + 8
    );
}

/// Text for XML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
