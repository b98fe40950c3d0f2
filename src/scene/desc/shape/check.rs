//! Values of shapes that do not go together.

use super::{ShapeDesc, SweepCurve};
use crate::table::Table;

/// Largest number of points of a curve.
pub const MOST_CURVE_POINTS: usize = 10_000;
/// Largest number of characters of a text.
const MOST_CHARACTERS: usize = 1000;
/// Largest number of vertices, and of triangles, of a mesh.
const MOST: usize = 2_000_000;

/// Refuses values of a shape that do not go together.
pub fn shape(it: &ShapeDesc, t: &mut Table) {
    match it {
        ShapeDesc::Text { text, .. } => check_text(t, text),
        &ShapeDesc::Torus {
            radius,
            tube_radius,
            ..
        } if t.clean() && tube_radius > radius => {
            let message = format!("`tube_radius` must be at most `radius`, which is {radius}");
            let help = "a larger tube would pass through itself in the middle";
            t.refuse("out-of-range", "tube_radius", &message, help);
        }
        &ShapeDesc::Capsule { radius, height, .. } if t.clean() && height < 2.0 * radius => {
            let message = format!("`height` must be at least twice `radius`, which is {radius}");
            let help = "it is from end to end; a sphere has `height` of twice the radius";
            t.refuse("out-of-range", "height", &message, help);
        }
        ShapeDesc::Sweep { .. } => check_sweep(t, it),
        ShapeDesc::Mesh {
            positions,
            indices,
            normals,
            uv,
            colors,
            ..
        } => {
            let others = [
                ("normals", normals.len(), 3),
                ("uv", uv.len(), 2),
                ("colors", colors.len(), 3),
            ];
            check_mesh(t, positions, indices, others);
        }
        _ => {}
    }
}

fn check_sweep(t: &mut Table, sweep: &ShapeDesc) {
    let &ShapeDesc::Sweep {
        ref points,
        curve,
        closed,
        twist_deg,
        taper,
        ..
    } = sweep
    else {
        return;
    };
    if let Some(message) = wrong_curve(points, curve, closed) {
        let help = "write the points that the curve goes through: `points = [[0, 0, 0], [0, 1, 0], [1, 1, 0]]`";
        t.refuse("out-of-range", "points", &message, help);
        return;
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
}

/// Message about points that are no curve.
pub fn wrong_curve(points: &[[f32; 3]], curve: SweepCurve, closed: bool) -> Option<String> {
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

fn check_text(t: &mut Table, text: &str) {
    let count = text.chars().count();
    if count > MOST_CHARACTERS {
        let message = format!("`text` must be at most {MOST_CHARACTERS} characters, not {count}");
        t.refuse(
            "out-of-range",
            "text",
            &message,
            "split it into several texts",
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
}

fn check_mesh(
    t: &mut Table,
    positions: &[f32],
    indices: &[f32],
    others: [(&'static str, usize, usize); 3],
) {
    let vertices = positions.len() / 3;
    check_count(
        t,
        "positions",
        positions.len(),
        "vertices, three numbers each",
        3,
    );
    check_count(
        t,
        "indices",
        indices.len(),
        "triangles, three numbers each",
        1,
    );
    for (key, found, each) in others {
        if t.has(key) && found != each * vertices {
            let wanted = each * vertices;
            let message = format!(
                "`{key}` must be {wanted} numbers, {each} for each of {vertices} vertices, not {found}"
            );
            t.refuse(
                "wrong-length",
                key,
                &message,
                "add as many as there are vertices",
            );
        }
    }
    let wrong = |x: &f32| x.fract() != 0.0 || *x as usize >= vertices;
    if let Some(at) = indices.iter().position(wrong) {
        let message = format!(
            "`indices[{at}]` must be the number of a vertex, 0 to {}, not {}",
            vertices.saturating_sub(1),
            indices[at]
        );
        t.refuse(
            "out-of-range",
            "indices",
            &message,
            "vertices are numbered from 0",
        );
    }
}

/// Refuses numbers that are not three for each of `least` or more things.
fn check_count(t: &mut Table, key: &str, found: usize, things: &str, least: usize) {
    let count = found / 3;
    if !found.is_multiple_of(3) || !(least..=MOST).contains(&count) {
        let message = format!("`{key}` must be {least} to {MOST} {things}, not {found} numbers");
        let help = match count > MOST {
            true => "use fewer, or several models",
            false => "write three numbers for each",
        };
        t.refuse("wrong-length", key, &message, help);
    }
}
