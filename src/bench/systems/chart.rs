//! Chart of systems, in a scene or over several: time against error, a dot for each.

use plotters::{coord::CoordTranslate, prelude::*};

use super::{SceneRows, System, overall::Overall};
use crate::{
    pareto::{Spot, pareto_front},
    report::chart::escape,
    summary::digits,
};

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
pub fn of_scene(scene: &SceneRows) -> Result<String, String> {
    let rows = scene.rows.iter();
    let dots: Vec<_> = rows
        .filter_map(|row| Some((row.system, row.spot()?)))
        .collect();
    draw(&dots, "milliseconds of the passes that find reflections")
}

/// Draws systems over several scenes as SVG.
///
/// # Errors
/// Message of the drawing library.
pub fn of_several(systems: &[Overall]) -> Result<String, String> {
    let systems = systems.iter();
    let dots: Vec<_> = systems.map(|of| (of.system, of.spot())).collect();
    draw(
        &dots,
        "time of the passes that find reflections, over that of rt",
    )
}

/// Draws named spots as SVG.
fn draw(dots: &[(&str, Spot)], time: &str) -> Result<String, String> {
    let said = |error: &dyn std::fmt::Display| format!("the chart cannot be drawn: {error}");
    let spots: Vec<Spot> = dots.iter().map(|(_, spot)| *spot).collect();
    let most = |of: fn(&Spot) -> f64| spots.iter().map(of).fold(0.0, f64::max);
    let times = 0.0..(1.1 * most(|spot| spot.ms)).max(1e-3);
    let errors =
        (LEAST_FLIP * 0.7..most(|spot| spot.error).max(10.0 * LEAST_FLIP) * 1.5).log_scale();
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
            .x_desc(time)
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
        let marks = dots.iter().zip(pareto_front(&spots));
        for (line, ((name, spot), is_on_front)) in (0..).zip(marks) {
            let Some(system) = System::named(name) else {
                continue;
            };
            let at = to_pixels.translate(&(spot.ms, spot.error.max(LEAST_FLIP)));
            dot(&mut overlay, at, system.color, is_on_front);
            let place = (SIZE.0 as i32 - 226, 30 + LINE_PX * line);
            dot(&mut overlay, place, system.color, is_on_front);
            overlay += &format!(
                "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"13\">{}</text>\n",
                place.0 + 12,
                place.1 + 4,
                escape(name)
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
