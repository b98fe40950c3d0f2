//! Values of shapes that take more than one key, or another shape.

use std::sync::Arc;

use super::{LatheSource, OutlineDesc, PartDesc, ShapeDesc};
use crate::{
    range::{ANY, Range},
    suggest,
    syntax::Node,
    table::{
        Table,
        points::{Numbers, Points},
    },
};

/// Largest number of points of an outline that is turned.
const MOST_POINTS: usize = 1000;
/// Largest number of shapes of a shape.
const MOST_PARTS: usize = 100;

/// Advice for the name of a kind in place of a shape's table.
pub fn kind_of(key: &str, value: &Node) -> Option<String> {
    let kind = suggest::text(value.get_ref().as_str()?);
    Some(format!("write `{key} = {{ kind = {kind} }}`"))
}

impl LatheSource {
    /// Reads `points` or `outline`.
    pub(super) fn read(t: &mut Table) -> Option<Self> {
        t.one_of(true, &[&["points"], &["outline"]]);
        let points = t.find("points", ANY).map(|Points(points)| points);
        let outline = t.table("outline").map(Self::Outline);
        if let Some(message) = points.as_deref().and_then(wrong_points) {
            let help = turned_round(points.as_deref().unwrap_or_default()).unwrap_or_else(|| {
                "write the outline from below upwards: `points = [[0.3, 0], [0.5, 0.4], [0, 0.8]]`"
                    .to_owned()
            });
            t.refuse("out-of-range", "points", &message, &help);
            return None;
        }
        points.map(Self::Points).or(outline)
    }
}

/// Advice for points whose heights come first, as they rise from below the middle.
fn turned_round(points: &[[f32; 2]]) -> Option<String> {
    let rises = (3..=12).contains(&points.len()) && points.windows(2).all(|it| it[0][0] < it[1][0]);
    let swapped: Vec<_> = points
        .iter()
        .map(|[height, radius]| [*radius, *height])
        .collect();
    let is_meant = rises && points[0][0] < 0.0 && wrong_points(&swapped).is_none();
    let swapped: Vec<_> = swapped.iter().map(|[r, h]| format!("[{r}, {h}]")).collect();
    let swapped = swapped.join(", ");
    is_meant.then(|| format!("the radius comes first, then the height: `points = [{swapped}]`"))
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

/// Reads the `outline` of a figure with a thickness.
pub fn outline(t: &mut Table) -> Option<OutlineDesc> {
    t.need_table("outline", "{ points = [[0, 0], [1, 0], [0.5, 0.8]] }")
}

/// Reads the `outline` of a profile that is moved along a curve.
pub fn profile(t: &mut Table) -> Option<OutlineDesc> {
    let circle = OutlineDesc::circle(0.05, t.written("points"));
    let outline = t.table("outline");
    outline.or_else(|| (!t.has("outline")).then_some(circle))
}

/// Reads many numbers; none where they are left out.
pub fn numbers(t: &mut Table, key: &'static str, range: Range) -> Option<Arc<[f32]>> {
    let numbers = t.find(key, range).map(|Numbers(numbers)| numbers);
    Some(numbers.unwrap_or_default())
}

/// Reads the shapes of a shape of shapes.
pub fn parts(t: &mut Table) -> Option<Vec<PartDesc>> {
    t.one_of(true, &[&["parts"]]);
    let errors = t.report.errors();
    let parts = t.list::<PartDesc>("parts");
    let count = parts.len();
    let is_read = t.has("parts") && t.report.errors() == errors;
    if is_read && !(2..=MOST_PARTS).contains(&count) {
        let message = format!("`parts` must be 2 to {MOST_PARTS} shapes, not {count}");
        let help =
            "write `parts = [{ shape = { kind = \"box\" } }, { shape = { kind = \"sphere\" } }]`";
        t.refuse("out-of-range", "parts", &message, help);
    }
    (!parts.is_empty()).then_some(parts)
}

/// Reads the shape of a part of another shape.
pub fn part(t: &mut Table) -> Option<ShapeDesc> {
    let shape = t.need_table("shape", "{ kind = \"box\" }");
    refuse_dynamic(t, shape.as_ref());
    shape
}

/// Reads the shape that is displaced.
pub fn displaced(t: &mut Table) -> Option<Box<ShapeDesc>> {
    let shape = t.need_table("shape", "{ kind = \"sphere\" }");
    refuse_dynamic(t, shape.as_ref());
    shape.map(Box::new)
}

/// Refuses a mesh that scripts deform as a part of another shape, which is made of it once.
fn refuse_dynamic(t: &mut Table, shape: Option<&ShapeDesc>) {
    if shape.is_some_and(|shape| shape.deforming_vertices().is_some()) {
        t.refuse(
            "wrong-source",
            "shape",
            "a mesh with `dynamic = true` cannot be a part of another shape, which is made of it once",
            "leave out `dynamic`, or make it the shape of a model of its own",
        );
    }
}
