//! Readers of shapes that are made of a flat figure: turned, thickened, or moved along a curve.

use super::outline::{self, SEGMENTS};
use crate::table::{Table, points::Points};
use crate::{
    desc::{BevelDesc, FontDesc, LatheSource, ShapeDesc, SweepCurve, TextAlign},
    range::{ABOVE_0, ANY, FROM_0, Range, range},
};

/// Range of a part of a turn, degrees.
pub(super) const TURN_DEG: Range = range(0.0, 360.0).above();
/// Largest number of points of an outline that is turned.
const MOST_POINTS: usize = 1000;

pub(super) fn lathe(t: &mut Table) -> Option<ShapeDesc> {
    t.one_of(true, &[&["points"], &["outline"]]);
    let points = t.find("points", ANY);
    let outline = t.table("outline").map(LatheSource::Outline);
    let segments = t.get("segments", SEGMENTS, 64);
    let angle_deg = t.get("angle_deg", TURN_DEG, 360.0);
    let points = points.map(|Points(points)| points);
    if let Some(message) = points.as_deref().and_then(wrong_points) {
        let help =
            "write the outline from below upwards: `points = [[0.3, 0], [0.5, 0.4], [0, 0.8]]`";
        t.refuse("out-of-range", "points", &message, help);
        return None;
    }
    Some(ShapeDesc::Lathe {
        source: points.map(LatheSource::Points).or(outline)?,
        segments,
        angle_deg,
    })
}

/// Message about points that a lathe cannot turn.
fn wrong_points(points: &[[f32; 2]]) -> Option<String> {
    let flat = |pair: &[[f32; 2]]| pair[0] == pair[1];
    if !(2..=MOST_POINTS).contains(&points.len()) {
        let count = points.len();
        Some(format!(
            "`points` must be 2 to {MOST_POINTS} points, not {count}"
        ))
    } else if let Some([radius, _]) = points.iter().find(|[radius, _]| *radius < 0.0) {
        Some(format!(
            "a point of `points` must be 0 or more from the axis, not {radius}"
        ))
    } else if points.windows(2).any(flat) {
        Some("two points of `points` in a row must differ".to_owned())
    } else if points.iter().all(|[radius, _]| *radius == 0.0) {
        Some("`points` must not all lie on the axis".to_owned())
    } else {
        None
    }
}

/// Range of the number of steps of a bevel.
const BEVEL_SEGMENTS: Range = range(1.0, 64.0);

/// The keys of a bevel that may reach as far as `most`, which `words` describe.
pub(super) fn bevel(t: &mut Table, most: f32, words: &str) -> BevelDesc {
    let width = t.get("bevel", FROM_0, 0.0);
    if t.clean() && width > most {
        let message = format!("`bevel` must be at most {words}, which is {most}");
        let help = format!("write `bevel = {most}` or less: it is cut off from both sides");
        t.refuse("out-of-range", "bevel", &message, &help);
    }
    let segments = t.get("bevel_segments", BEVEL_SEGMENTS, 4);
    BevelDesc { width, segments }
}

pub(super) fn extrude(t: &mut Table) -> Option<ShapeDesc> {
    let example = "{ points = [[0, 0], [1, 0], [0.5, 0.8]] }";
    let outline = t.need_table("outline", example);
    let depth = t.get("depth", ABOVE_0, 0.1);
    let bevel = bevel(t, depth / 2.0, "half of `depth`");
    Some(ShapeDesc::Extrude {
        outline: outline?,
        depth,
        bevel,
    })
}

/// Largest number of points of a curve.
pub(super) const MOST_CURVE_POINTS: usize = 10_000;

pub(super) fn sweep(t: &mut Table) -> Option<ShapeDesc> {
    let at = t.written("points");
    let has_outline = t.has("outline");
    let outline = t.table("outline");
    let points = t.need("points", ANY);
    let curve = t.get("curve", ANY, SweepCurve::default());
    let closed = t.get("closed", ANY, false);
    let twist_deg = t.get("twist_deg", ANY, 0.0);
    let taper = t.get("taper", range(0.0, 1000.0), 1.0);
    let segments = t.get("segments", range(1.0, 256.0), 16);
    let default = || outline::circle(0.05, at.clone());
    let outline = outline.or_else(|| (!has_outline).then(default));
    let Points(points) = points?;
    if let Some(message) = wrong_curve(&points, curve, closed) {
        let help = "write the points that the curve goes through: `points = [[0, 0, 0], [0, 1, 0], [1, 1, 0]]`";
        t.refuse("out-of-range", "points", &message, help);
        return None;
    }
    if t.clean() && closed && twist_deg % 360.0 != 0.0 {
        let message =
            "`twist_deg` of a closed curve must be a multiple of 360, so that its ends meet";
        t.refuse("out-of-range", "twist_deg", message, "write 0, 360 or -360");
    }
    if t.clean() && closed && taper != 1.0 {
        let message = "`taper` of a closed curve must be 1, so that its ends meet";
        t.refuse(
            "out-of-range",
            "taper",
            message,
            "remove `taper`, or `closed`",
        );
    }
    Some(ShapeDesc::Sweep {
        outline: outline?,
        points,
        curve,
        closed,
        twist_deg,
        taper,
        segments,
        at,
    })
}

/// Message about points that are no curve.
pub(super) fn wrong_curve(points: &[[f32; 3]], curve: SweepCurve, closed: bool) -> Option<String> {
    let (count, least) = (points.len(), if closed { 3 } else { 2 });
    if !(least..=MOST_CURVE_POINTS).contains(&count) {
        return Some(format!(
            "`points` must be {least} to {MOST_CURVE_POINTS} points, not {count}"
        ));
    }
    if curve == SweepCurve::Bezier {
        let (over, words) = match closed {
            true => (0, "3, 6, 9 and so on"),
            false => (1, "4, 7, 10 and so on"),
        };
        return (count % 3 != over || count < 3).then(|| {
            format!("`points` of a Bézier curve must be {words}, with two handles between two points, not {count}")
        });
    }
    let same = |pair: &[[f32; 3]]| pair[0] == pair[1];
    let same = points.windows(2).position(same);
    let ends = closed && points[0] == points[count - 1];
    let twice = same.or(ends.then_some(count - 1))?;
    Some(format!(
        "two points of `points` in a row must differ; points {} and {} do not",
        twice + 1,
        (twice + 1) % count + 1
    ))
}

/// Largest number of characters of a text.
const MOST_CHARACTERS: usize = 1000;

pub(super) fn text(t: &mut Table) -> Option<ShapeDesc> {
    let at = t.written("text");
    let text = t.need::<String>("text", ANY);
    let font_at = t.written("font");
    let font = t.find::<String>("font", ANY);
    let size = t.get("size", ABOVE_0, 0.2);
    let depth = t.get("depth", ABOVE_0, 0.05);
    let bevel = bevel(t, depth / 2.0, "half of `depth`");
    let align = t.get("align", ANY, TextAlign::default());
    let line_height = t.get("line_height", range(0.0, 100.0), 1.2);
    let letter_spacing = t.get("letter_spacing", range(-1.0, 100.0), 0.0);
    let segments = t.get("segments", SEGMENTS, 64);
    let text = text?;
    let count = text.chars().count();
    if count > MOST_CHARACTERS {
        let message = format!("`text` must be at most {MOST_CHARACTERS} characters, not {count}");
        t.refuse(
            "out-of-range",
            "text",
            &message,
            "split it into several models",
        );
    } else if text.trim().is_empty() {
        t.refuse(
            "empty-text",
            "text",
            "`text` has no letters",
            "write some, or remove the model",
        );
    }
    let is_control = |c: char| c.is_control() && c != '\n' && c != '\r';
    if let Some((byte, c)) = text.char_indices().find(|(_, c)| is_control(*c)) {
        let message = format!(
            "`text` has the control character U+{:04X}, which no letter stands for",
            u32::from(c)
        );
        let help = match c {
            '\t' => "write spaces in place of a tab",
            _ => "remove it; `\\n` begins a new line",
        };
        t.refuse_byte("control-character", "text", byte, (&message, help));
    }
    Some(ShapeDesc::Text {
        text,
        font: font.map(|file| FontDesc { file, at: font_at }),
        size,
        depth,
        bevel,
        align,
        line_height,
        letter_spacing,
        segments,
        at,
    })
}
