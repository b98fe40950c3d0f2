//! Line charts as SVG: time and SSIM over the frames of an animation, a line per setting; errors over a
//! parameter, a line per method.

use crate::sample::curve::{series, series_names};

use plotters::{coord::CoordTranslate, prelude::*};

use super::{
    canvas::{Canvas, said},
    chart::{color, escape},
};
use crate::summary::{Group, Metric, Point, digits};
use reflet_scene::words;

words! {
    /// Quantities on the axes of a line chart, with the word in the name of its file and the caption that explains how to
    /// read it.
    pub enum LineChart {
        /// FLIP over the one parameter that all points share.
        ErrorByParameter = "parameter":
            "What the parameter does to the error. A method that it does nothing for is a level line.",
        /// Wall time over the frames of an animation.
        Milliseconds = "ms": "Wall time of each frame that was measured, a line per setting.",
        /// SSIM of the frame over the frames of an animation.
        Ssim = "ssim": "SSIM of each frame that was measured against rt, a line per setting: 1 is equal.",
        /// Flicker (difference of the frame's change from the reference's) over the frames of an animation.
        Flicker = "flicker":
            "Flicker: how far the change of each frame since the measured frame before is from that of rt, mean over the \
             reflective pixels, of 255 levels. 0 where a picture changes exactly as rt does.",
    }
}

/// A line of dots in the color of its method.
struct Line {
    method: &'static str,
    /// Hover text of its dots.
    name: String,
    dots: Vec<(f64, f64)>,
}

/// Lines and axis labels of a chart.
struct Plot {
    lines: Vec<Line>,
    x_title: String,
    y_title: &'static str,
    /// Whether x values are logarithms (base 10) of the labeled values.
    log_x: bool,
    bottom: f64,
    top: f64,
}

/// Width of a chart, pixels.
const WIDTH: i32 = 860;

/// Draws a line chart; none where a group has no such data.
///
/// # Errors
/// Message of the drawing library.
pub fn draw(group: &Group, chart: LineChart) -> Result<Option<String>, String> {
    let plot = match chart {
        LineChart::ErrorByParameter => over_parameter(group),
        _ => over_frames(group, chart),
    };
    plot.map(|plot| svg(&plot)).transpose()
}

/// A named line of dots over error bounds.
pub struct Curve {
    /// Name: `bound`, `estimated`, `measured`, or a time's.
    pub name: &'static str,
    /// Bounds, more than 0, and values.
    pub dots: Vec<(f64, f64)>,
}

/// Draws values over error bounds, from 0 up; bounds are spaced by their logarithms.
///
/// # Errors
/// Message of the drawing library.
pub fn over_bounds(curves: &[Curve], y_title: &'static str) -> Result<String, String> {
    let line = |curve: &Curve| {
        let dots = curve
            .dots
            .iter()
            .map(|(bound, value)| (bound.log10(), *value));
        Line {
            method: curve.name,
            name: curve.name.to_owned(),
            dots: dots.filter(|(_, value)| value.is_finite()).collect(),
        }
    };
    let lines: Vec<Line> = curves.iter().map(line).collect();
    let values = lines.iter().flat_map(|line| &line.dots).map(|(_, y)| *y);
    let top = values.fold(1e-6, f64::max) * 1.15;
    svg(&Plot {
        lines,
        x_title: "error bound".to_owned(),
        y_title,
        log_x: true,
        bottom: 0.0,
        top,
    })
}

fn over_frames(group: &Group, chart: LineChart) -> Option<Plot> {
    let value = |point: &Point| match chart {
        LineChart::Milliseconds => Some(point.frame_ms.median),
        LineChart::Flicker => point.sample.mask_temporal_difference,
        _ => point.sample.ssim,
    };
    let mut lines: Vec<Line> = Vec::new();
    for method in series_names() {
        let has_one = group
            .points
            .iter()
            .filter(|p| series(&p.sample) == method)
            .count()
            < 2;
        let of = group.over_frames.iter();
        for (frame, point) in of.filter(|(_, point)| series(&point.sample) == method) {
            let Some(y) = value(point) else { continue };
            let name = if has_one {
                method.to_owned()
            } else {
                point.label()
            };
            let dot = (f64::from(*frame), y);
            match lines.iter_mut().find(|line| line.name == name) {
                Some(line) => line.dots.push(dot),
                None => lines.push(Line {
                    method,
                    name,
                    dots: vec![dot],
                }),
            }
        }
    }
    for line in &mut lines {
        // Runs that were resumed with another stride have their frames in another order.
        line.dots.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    let [low, high] = range(&lines)?;
    let (bottom, top, y_title) = match chart {
        LineChart::Milliseconds => (0.0, high * 1.2, "milliseconds a frame (wall time)"),
        LineChart::Flicker => {
            let title = "flicker in reflections, of 255 levels";
            (0.0, (high * 1.2).max(1e-3), title)
        }
        _ => (low - 0.1 * (1.0 - low).max(1e-4), 1.0, "SSIM, whole frame"),
    };
    Some(Plot {
        lines,
        x_title: "frame".to_owned(),
        y_title,
        log_x: false,
        bottom,
        top,
    })
}

/// Plot of errors over the parameter; a method on which it has no effect is a level line.
fn over_parameter(group: &Group) -> Option<Plot> {
    let parameter = group.points.first()?.sample.parameter.clone()?;
    let values = group.points.iter().filter_map(|p| p.sample.value);
    let [first, last] = values.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], v| {
        [low.min(v), high.max(v)]
    });
    let is_shared = |p: &Point| p.sample.parameter.as_deref() == Some(parameter.as_str());
    if !group.points.iter().all(is_shared) || first >= last {
        return None;
    }
    let log_x = first > 0.0 && last > 8.0 * first;
    let x = |value: f64| if log_x { value.log10() } else { value };
    let line = |method: &'static str| {
        let of = group.points.iter().filter(|p| series(&p.sample) == method);
        let dots = of.filter_map(|p| Some((p.sample.value, p.error(Metric::Flip, group.masked)?)));
        let ends = |(value, error): (Option<f64>, f64)| match value {
            Some(value) => vec![(x(value), error)],
            None => vec![(x(first), error), (x(last), error)],
        };
        Line {
            method,
            name: method.to_owned(),
            dots: dots.flat_map(ends).collect(),
        }
    };
    let lines: Vec<Line> = series_names().map(line).collect();
    let [_, high] = range(&lines)?;
    Some(Plot {
        lines,
        x_title: parameter,
        y_title: if group.masked {
            "FLIP, in reflections"
        } else {
            "FLIP, whole frame"
        },
        log_x,
        bottom: 0.0,
        top: (high * 1.15).max(1e-6),
    })
}

/// Smallest and largest value; none for fewer than two dots.
fn range(lines: &[Line]) -> Option<[f64; 2]> {
    let values = || lines.iter().flat_map(|line| &line.dots).map(|(_, y)| *y);
    let low = values().fold(f64::INFINITY, f64::min);
    let high = values().fold(f64::NEG_INFINITY, f64::max);
    (values().count() > 1).then_some([low, high])
}

fn svg(plot: &Plot) -> Result<String, String> {
    let xs = || {
        plot.lines
            .iter()
            .flat_map(|line| &line.dots)
            .map(|(x, _)| *x)
    };
    let first = xs().fold(f64::INFINITY, f64::min);
    let last = xs().fold(f64::NEG_INFINITY, f64::max).max(first + 1e-9);
    let shown = |x: &f64| match x {
        x if plot.log_x => digits(10f64.powf(*x)),
        x if x.fract() == 0.0 => x.to_string(), // a frame
        x => digits(*x),
    };
    let canvas = Canvas {
        size: (WIDTH as u32, 360),
        above: 36, // the legend stands there, over no line
        right: 34,
        titles: [&plot.x_title, plot.y_title],
        grid: [242, 220],
        x_label: &shown,
    };
    canvas.svg(first..last, plot.bottom..plot.top, |chart| {
        let mut overlay = legend(plot);
        for line in plot.lines.iter().filter(|line| !line.dots.is_empty()) {
            let stroke = color(line.method).stroke_width(2);
            let series = LineSeries::new(line.dots.clone(), stroke).point_size(3);
            chart.draw_series(series).map_err(said)?;
        }
        let to_pixels = chart.as_coord_spec();
        for line in &plot.lines {
            for &(x, y) in &line.dots {
                let (x_title, x_shown) = (&plot.x_title, shown(&x));
                let what = format!("{}, {x_title} {x_shown}: {}", line.name, digits(y));
                hover(&mut overlay, to_pixels.translate(&(x, y)), &what);
            }
        }
        Ok(overlay)
    })
}

/// Adds an invisible dot with a hover text.
fn hover(out: &mut String, (x, y): (i32, i32), text: &str) {
    *out += &format!(
        "<circle cx=\"{x}\" cy=\"{y}\" r=\"6\" fill-opacity=\"0\"><title>{}</title></circle>\n",
        escape(text)
    );
}

/// Legend of the drawn methods, above the chart.
fn legend(plot: &Plot) -> String {
    let drawn = plot.lines.iter().filter(|line| !line.dots.is_empty());
    let mut methods: Vec<&str> = drawn.map(|line| line.method).collect();
    methods.dedup();
    let mut out = String::new();
    for (index, method) in methods.iter().enumerate() {
        let x = WIDTH - 34 - 90 * (methods.len() - index) as i32;
        let RGBColor(r, g, b) = color(method);
        out += &format!(
            "<path d=\"M{x} 20h20\" stroke=\"rgb({r},{g},{b})\" stroke-width=\"2\"/>\
             <text x=\"{}\" y=\"24\" font-family=\"sans-serif\" font-size=\"13\">{method}</text>\n",
            x + 26
        );
    }
    out
}
