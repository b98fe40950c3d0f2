//! Chart of the systems of a scene: time against error, a dot for each.

use plotters::{coord::CoordTranslate, prelude::*};

use super::{Row, SceneRows, System, on_front};
use crate::{report::chart::escape, summary::digits};

/// Size of a chart, pixels.
const SIZE: (u32, u32) = (860, 420);
/// Height of a line of the legend, pixels.
const LINE_PX: i32 = 18;
/// Error at which exact pictures are drawn.
const LEAST_FLIP: f64 = 1e-4;

/// Draws a scene's systems as SVG.
///
/// # Errors
/// Message of the drawing library.
pub fn draw(scene: &SceneRows) -> Result<String, String> {
    let said = |error: &dyn std::fmt::Display| format!("the chart cannot be drawn: {error}");
    let rows = &scene.rows;
    let most = |of: fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    let times = 0.0..(1.1 * most(|r| r.ms)).max(1e-3);
    let errors = (LEAST_FLIP * 0.7..most(|r| r.flip).max(10.0 * LEAST_FLIP) * 1.5).log_scale();
    let (mut svg, mut overlay) = (String::new(), String::new());
    {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(|e| said(&e))?;
        let mut chart = ChartBuilder::on(&root)
            .margin(14)
            .margin_right(240)
            .x_label_area_size(44)
            .y_label_area_size(74)
            .build_cartesian_2d(times, errors)
            .map_err(|e| said(&e))?;
        chart
            .configure_mesh()
            .x_desc("milliseconds of the passes that find reflections")
            .y_desc("mean FLIP against rt, in reflections")
            .x_label_formatter(&|ms| digits(*ms))
            .y_label_formatter(&|error| digits(*error))
            .light_line_style(RGBColor(238, 238, 238))
            .bold_line_style(RGBColor(214, 214, 214))
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .draw()
            .map_err(|e| said(&e))?;
        let to_pixels = chart.as_coord_spec();
        let marks = rows.iter().zip(on_front(rows));
        for (line, (row, is_on_front)) in (0..).zip(marks) {
            let Some(system) = System::named(row.system) else {
                continue;
            };
            let at = to_pixels.translate(&(row.ms, row.flip.max(LEAST_FLIP)));
            dot(&mut overlay, at, system.color, is_on_front);
            let place = (SIZE.0 as i32 - 226, 30 + LINE_PX * line);
            dot(&mut overlay, place, system.color, is_on_front);
            overlay += &format!(
                "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"13\">{}</text>\n",
                place.0 + 12,
                place.1 + 4,
                escape(row.system)
            );
        }
        root.present().map_err(|e| said(&e))?;
    }
    let end = svg.rfind("</svg>").ok_or("the chart has no end")?;
    svg.insert_str(end, &overlay);
    Ok(svg)
}

/// A dot, with a ring where it is on the front.
fn dot(svg: &mut String, (x, y): (i32, i32), [r, g, b]: [u8; 3], is_on_front: bool) {
    *svg += &format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"5\" fill=\"rgb({r},{g},{b})\"/>\n");
    if is_on_front {
        *svg += &format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"8\" fill=\"none\" stroke=\"rgb(60,60,60)\"/>\n"
        );
    }
}
