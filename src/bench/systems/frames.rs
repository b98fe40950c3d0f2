//! Systems frame by frame: the rows of a table, and charts of curves over the frames of a film.

use plotters::{coord::CoordTranslate, prelude::*};

use super::{
    SceneRows, Side, System, SystemErrors,
    chart::{LEAST_FLIP, LEGEND_PX, LINE_PX, named},
};
use crate::{
    cell::{Cell, Column, cells, names},
    csv,
    report::{
        canvas::{Canvas, said},
        chart::escape,
    },
    summary::digits,
};
use reflet_scene::words;

/// Size of a chart, pixels.
const SIZE: (u32, u32) = (1000, 430);

/// Measurements of a system in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRow {
    /// Number of the frame.
    pub frame: u32,
    /// Time of the passes that find reflections, milliseconds: processor time on software adapters.
    pub ms: f64,
    /// Time in which maps or structures were made anew for this frame, milliseconds; it is not part of `ms`.
    pub update_ms: f64,
    /// Errors; none where the frame has too few reflective pixels.
    pub errors: Option<SystemErrors>,
}

words! {
    /// Quantity on the vertical axis of a chart, which is logarithmic, with the ending of its file's name and a sentence
    /// about it.
    pub enum Curves {
        /// Time, including maps and structures that were made anew for the frame.
        Time = "-ms": "Time of the passes that find reflections over the frames, with maps and structures made anew",
        /// Mean FLIP.
        Error = "-flip": "Mean FLIP over the frames",
    }
}

impl Curves {
    const fn title(self) -> &'static str {
        match self {
            Self::Time => "milliseconds, with maps and structures made anew",
            Self::Error => "mean FLIP against rt, in reflections",
        }
    }

    /// Value of a frame; none where it has none above 0.
    fn value(self, row: &FrameRow) -> Option<f64> {
        let value = match self {
            Self::Time => row.ms + row.update_ms,
            Self::Error => row.errors?.flip.max(LEAST_FLIP),
        };
        (value > 0.0).then_some(value)
    }

    /// First and last frame, lowest and highest value of the chart; none where there is nothing to draw.
    fn ranges(self, scene: &SceneRows) -> Option<([u32; 2], [f64; 2])> {
        let rows = || scene.rows.iter().flat_map(|row| &row.frames);
        let first = rows().map(|row| row.frame).min()?;
        let last = rows().map(|row| row.frame).max()?;
        let shown = || rows().filter_map(|row| self.value(row));
        let low = shown().fold(f64::INFINITY, f64::min);
        let high = shown().fold(0.0, f64::max);
        (first != last && high > 0.0).then_some(([first, last], [low, high]))
    }
}

/// Columns of a frame.
const FRAME: &[Column<FrameRow>] = &[
    Column("frame", |of| of.frame.text()),
    Column("ms", |of| of.ms.text()),
    Column("update_ms", |of| of.update_ms.text()),
    Column("flip", |of| of.errors.map(|errors| errors.flip).text()),
    Column("ssim", |of| of.errors.and_then(|errors| errors.ssim).text()),
    Column("wrong_percent", |of| {
        of.errors.map(|errors| errors.wrong_percent).text()
    }),
];

/// Table with a row for each scene, system and frame.
pub fn table(scenes: &[SceneRows]) -> String {
    let mut out = csv::line(["scene", "system"].into_iter().chain(names(FRAME)));
    for (scene, row) in (scenes.iter()).flat_map(|of| of.rows.iter().map(move |row| (of, row))) {
        for of in &row.frames {
            let system = [scene.scene.clone(), row.system.to_owned()];
            out += &csv::line(system.into_iter().chain(cells(FRAME, of)));
        }
    }
    out
}

/// Draws a curve for each system over the frames as SVG; none for a still.
///
/// # Errors
/// Message of the drawing library.
pub fn draw(scene: &SceneRows, curves: Curves) -> Result<Option<String>, String> {
    let Some(([first, last], [low, high])) = curves.ranges(scene) else {
        return Ok(None);
    };
    let values = (0.8 * low..1.25 * high.max(10.0 * low)).log_scale();
    let canvas = Canvas {
        size: SIZE,
        above: 14,
        right: LEGEND_PX,
        titles: ["frame", curves.title()],
        grid: [242, 220],
        x_label: &|frame| format!("{frame:.0}"),
    };
    let svg = canvas.svg(f64::from(first)..f64::from(last), values, |chart| {
        let mut overlay = String::new();
        for (line, (row, system)) in (0..).zip(scene.of_systems()) {
            let dot = |of: &FrameRow| Some((f64::from(of.frame), curves.value(of)?));
            // A curve ends before a frame without a value.
            for run in row.frames.split(|of| dot(of).is_none()) {
                let series = LineSeries::new(run.iter().filter_map(dot), stroke(system));
                chart.draw_series(series).map_err(said)?;
            }
            let to_pixels = chart.as_coord_spec();
            for (frame, value) in row.frames.iter().filter_map(dot) {
                let (x, y) = to_pixels.translate(&(frame, value));
                let text = format!("{}, frame {frame:.0}: {}", system.name, digits(value));
                overlay += &format!(
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"5\" fill-opacity=\"0\"><title>{}</title></circle>\n",
                    escape(&text)
                );
            }
            overlay += &legend_line(system, 30 + LINE_PX * line);
        }
        Ok(overlay)
    })?;
    Ok(Some(svg))
}

/// Width of a system's curve, pixels: Reflet's own are wide.
fn width(system: &System) -> u32 {
    if system.side == Side::Own { 3 } else { 1 }
}

/// Stroke of a system's curve.
fn stroke(system: &System) -> ShapeStyle {
    let [r, g, b] = system.color;
    RGBColor(r, g, b).stroke_width(width(system))
}

/// Line of the legend, at this distance from the top.
fn legend_line(system: &System, y: i32) -> String {
    let ([r, g, b], x) = (system.color, SIZE.0 as i32 - 230);
    format!(
        "<path d=\"M{x} {y}h20\" stroke=\"rgb({r},{g},{b})\" stroke-width=\"{}\"/>{}",
        width(system),
        named((x + 26, y + 4), system.name)
    )
}

#[cfg(test)]
mod tests {
    use super::{super::Row, *};

    fn film(frames: &[u32]) -> SceneRows {
        let row = |system, factor: f64| Row {
            system,
            frames: (frames.iter())
                .map(|frame| FrameRow {
                    frame: *frame,
                    ms: factor * f64::from(frame + 1),
                    update_ms: 2.0,
                    errors: (frame % 100 != 50).then(SystemErrors::default),
                })
                .collect(),
            ..Row::default()
        };
        SceneRows {
            scene: "film.toml".to_owned(),
            frames: frames.len(),
            size: [64, 36],
            scored_px: vec![500],
            probes: 0,
            rows: vec![row("ssr", 1.0), row("near-far", 3.0)],
            left_out: Vec::new(),
        }
    }

    #[test]
    fn a_film_has_a_curve_of_each_system() {
        let film = film(&[0, 40, 80]);
        for (curves, value) in [(Curves::Time, "125"), (Curves::Error, "1.00e-4")] {
            let svg = draw(&film, curves).expect("drawn").expect("three frames");
            for name in ["ssr", "near-far"] {
                assert!(svg.contains(&format!(">{name}</text>")), "{svg}");
            }
            let dots = svg.matches("<circle").count();
            assert_eq!(dots, 6, "{curves:?}");
            // Structures made anew take time as well: 3 × 41 + 2.
            let text = format!("<title>near-far, frame 40: {value}</title>");
            assert!(svg.contains(&text), "{svg}");
        }
        let table = table(&[film]);
        assert_eq!(table.lines().count(), 7);
        assert!(table.contains("\nfilm.toml,near-far,80,243,2,0,,0\n"));
    }

    #[test]
    fn frames_without_errors_interrupt_the_curves_of_errors() {
        let lines = |frames: &[u32]| {
            let svg = draw(&film(frames), Curves::Error).expect("drawn");
            svg.expect("several frames").matches("<polyline").count()
        };
        // Two further curves of the two systems, beside the same axes.
        assert_eq!(lines(&[0, 40, 50, 60, 80]), lines(&[0, 40, 55, 60, 80]) + 2);
        assert!(table(&[film(&[50])]).contains("\nfilm.toml,ssr,50,51,2,,,\n"));
        assert_eq!(draw(&film(&[50, 150]), Curves::Error), Ok(None));
    }

    #[test]
    fn a_still_has_no_curves() {
        assert_eq!(draw(&film(&[7]), Curves::Time), Ok(None));
        assert_eq!(draw(&film(&[]), Curves::Error), Ok(None));
    }
}
