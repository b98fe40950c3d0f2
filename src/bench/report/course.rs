//! An animation over its frames as SVG: milliseconds, and SSIM, a line per method.

use plotters::prelude::*;

use super::chart::color;
use crate::bench::summary::{Group, Point, digits};

/// What is drawn over the frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// Wall time of the frame.
    Milliseconds,
    /// SSIM of the frame against the reference.
    Ssim,
}

/// Draws an animation; none for a still scene.
///
/// # Errors
/// What the drawing library says.
pub fn draw(group: &Group, course: Course) -> Result<Option<String>, String> {
    let value = |point: &Point| match course {
        Course::Milliseconds => Some(point.frame_ms.median),
        Course::Ssim => point.sample.ssim,
    };
    let judged = |(frame, point): &(u32, Point)| {
        let method = point.sample.method.clone();
        Some((method, (f64::from(*frame), value(point)?)))
    };
    let dots: Vec<(String, (f64, f64))> = group.over_frames.iter().filter_map(judged).collect();
    if dots.len() < 2 {
        return Ok(None);
    }
    let fold = |of: fn(&(f64, f64)) -> f64| {
        dots.iter()
            .map(|(_, at)| of(at))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            })
    };
    let (first, last) = fold(|at| at.0);
    let (low, high) = fold(|at| at.1);
    let (bottom, top, title) = match course {
        Course::Milliseconds => (0.0, high * 1.2, "milliseconds a frame (wall time)"),
        Course::Ssim => (low - 0.1 * (1.0 - low).max(1e-4), 1.0, "SSIM, whole frame"),
    };
    let said = |e: &dyn std::fmt::Display| format!("the chart cannot be drawn: {e}");
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (860, 360)).into_drawing_area();
        root.fill(&WHITE).map_err(|e| said(&e))?;
        let mut chart = ChartBuilder::on(&root)
            .margin(14)
            .x_label_area_size(44)
            .y_label_area_size(74)
            .build_cartesian_2d(first..last.max(first + 1.0), bottom..top)
            .map_err(|e| said(&e))?;
        chart
            .configure_mesh()
            .x_desc("frame")
            .y_desc(title)
            .y_label_formatter(&|v| digits(*v))
            .light_line_style(RGBColor(242, 242, 242))
            .bold_line_style(RGBColor(220, 220, 220))
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .draw()
            .map_err(|e| said(&e))?;
        for method in ["ssr", "hybrid", "rt"] {
            let of = dots.iter().filter(|(m, _)| m == method);
            let line: Vec<(f64, f64)> = of.map(|(_, at)| *at).collect();
            if line.is_empty() {
                continue;
            }
            let stroke = color(method).stroke_width(2);
            let series = LineSeries::new(line, stroke).point_size(3);
            let drawn = chart.draw_series(series).map_err(|e| said(&e))?;
            let key = move |(x, y)| PathElement::new(vec![(x, y), (x + 20, y)], stroke);
            drawn.label(method).legend(key);
        }
        chart
            .configure_series_labels()
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(204, 204, 204))
            .label_font(("sans-serif", 13))
            .draw()
            .map_err(|e| said(&e))?;
        root.present().map_err(|e| said(&e))?;
    }
    Ok(Some(svg))
}
