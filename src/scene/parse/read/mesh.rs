//! Reader of meshes that are written as numbers.

use std::sync::Arc;

use crate::table::{Table, points::Numbers};
use crate::{
    desc::ShapeDesc,
    range::{ANY, FROM_0, UNIT},
};

/// Largest number of vertices, and of triangles.
const MOST: usize = 2_000_000;

pub(super) fn mesh(t: &mut Table) -> Option<ShapeDesc> {
    let positions = t.need::<Numbers>("positions", ANY);
    let indices = t.need::<Numbers>("indices", FROM_0);
    let none = || Numbers(Arc::default());
    let normals = t.find("normals", ANY).unwrap_or_else(none).0;
    let uv = t.find("uv", ANY).unwrap_or_else(none).0;
    let colors = t.find("colors", UNIT).unwrap_or_else(none).0;
    let dynamic = t.get("dynamic", ANY, false);
    let (positions, indices) = (positions?.0, indices?.0);
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
    for (key, found, each) in [
        ("normals", normals.len(), 3),
        ("uv", uv.len(), 2),
        ("colors", colors.len(), 3),
    ] {
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
    Some(ShapeDesc::Mesh {
        positions,
        indices,
        normals,
        uv,
        colors,
        dynamic,
    })
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
