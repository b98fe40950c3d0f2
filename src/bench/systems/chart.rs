//! Chart of systems, in a scene or over several: time against error, a dot for each.

use plotters::{coord::CoordTranslate, prelude::*};

use super::{SceneRows, System, overall::Overall};
use crate::{
    pareto::{Spot, pareto_front},
    report::{canvas::Canvas, chart::escape},
    summary::digits,
};

/// Size of a chart, pixels.
const SIZE: (u32, u32) = (860, 420);
/// Margin to the right of a chart, in which the legend stands, pixels.
pub(super) const LEGEND_PX: i32 = 240;
/// Height of a line of the legend, pixels.
pub(super) const LINE_PX: i32 = 18;
/// Error at which exact pictures are drawn.
pub(super) const LEAST_FLIP: f64 = 1e-4;

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
    let spots: Vec<Spot> = dots.iter().map(|(_, spot)| *spot).collect();
    let most = |of: fn(&Spot) -> f64| spots.iter().map(of).fold(0.0, f64::max);
    let times = 0.0..(1.1 * most(|spot| spot.ms)).max(1e-3);
    let errors =
        (LEAST_FLIP * 0.7..most(|spot| spot.error).max(10.0 * LEAST_FLIP) * 1.5).log_scale();
    let canvas = Canvas {
        size: SIZE,
        above: 14,
        right: LEGEND_PX,
        titles: [time, "mean FLIP against rt, in reflections"],
        grid: [238, 214],
        x_label: &|ms| digits(*ms),
    };
    canvas.svg(times, errors, |chart| {
        let mut overlay = String::new();
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
            overlay += &named((place.0 + 12, place.1 + 4), name);
        }
        Ok(overlay)
    })
}

/// Name in the legend, with its left end and the bottom of its letters.
pub(super) fn named((x, y): (i32, i32), name: &str) -> String {
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"13\">{}</text>\n",
        escape(name)
    )
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
