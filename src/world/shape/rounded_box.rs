//! Boxes with cut or rounded edges.

use glam::{DVec2, DVec3};

use super::solid::{Corner, Solid};

/// A vertex of the grid, which runs around Y in columns and from the top down in rows.
#[derive(Clone, Copy)]
struct Vertex {
    at: DVec3,
    normal: DVec3,
}

/// Adds a box around the origin whose edges are cut (one step) or rounded: the points at a distance of up to `bevel`
/// from a smaller box.
pub fn add(solid: &mut Solid, half: DVec3, bevel: f64, steps: u32) {
    let steps = steps.max(1);
    let quarter = |step: u32| match step {
        0 => DVec2::Y,
        step if step == steps => DVec2::X,
        _ => {
            let angle = std::f64::consts::FRAC_PI_2 * f64::from(step) / f64::from(steps);
            DVec2::new(angle.sin(), angle.cos())
        }
    };
    let inner = (half - bevel).max(DVec3::ZERO);
    let vertex = |down: DVec2, side: f64, corner: u32, step: u32| {
        // From corner to corner the box turns by a quarter: x and z change places.
        let way = quarter(step);
        let (x, z) = match corner {
            0 => (way.x, way.y),
            1 => (way.y, -way.x),
            2 => (-way.x, -way.y),
            _ => (-way.y, way.x),
        };
        let (sign_x, sign_z) =
            [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)][corner as usize];
        let normal = DVec3::new(x * down.x, down.y * side, z * down.x);
        let at = inner * DVec3::new(sign_x, side, sign_z) + normal * bevel;
        Vertex { at, normal }
    };
    let upper = (0..=steps).map(|row| (quarter(row), 1.0));
    let lower = (0..=steps).rev().map(|row| (quarter(row), -1.0));
    let columns = || (0..4).flat_map(|corner| (0..=steps).map(move |step| (corner, step)));
    let rows: Vec<Vec<Vertex>> = upper
        .chain(lower)
        .map(|(down, side)| columns().map(|(c, s)| vertex(down, side, c, s)).collect())
        .collect();
    let is_flat = steps == 1;
    for pair in rows.windows(2) {
        let count = pair[0].len();
        for left in 0..count {
            let right = (left + 1) % count;
            let [top, below] = [&pair[0], &pair[1]];
            add_quad(
                solid,
                half,
                [top[left], below[left], below[right], top[right]],
                is_flat,
            );
        }
    }
    let stride = steps as usize + 1;
    let corners = |row: &[Vertex]| [0, 1, 2, 3].map(|corner| row[corner * stride]);
    add_quad(solid, half, corners(&rows[0]), false);
    let mut below = corners(&rows[rows.len() - 1]);
    below.reverse();
    add_quad(solid, half, below, false);
}

/// Adds a quadrilateral, with the texture coordinates of the box's face that it faces most.
fn add_quad(solid: &mut Solid, half: DVec3, vertices: [Vertex; 4], is_flat: bool) {
    let [a, b, c, d] = vertices.map(|vertex| vertex.at);
    let flat = (c - a).cross(d - b);
    let facing: DVec3 = vertices.iter().map(|vertex| vertex.normal).sum();
    let size = facing.abs();
    let sign = facing.signum();
    let (right, up) = if size.y >= size.x && size.y >= size.z {
        (DVec3::X, DVec3::NEG_Z * sign.y)
    } else if size.x >= size.z {
        (DVec3::NEG_Z * sign.x, DVec3::Y)
    } else {
        (DVec3::X * sign.z, DVec3::Y)
    };
    let corners = vertices.map(|vertex| {
        let at = vertex.at / half;
        let uv = DVec2::new(0.5 + 0.5 * at.dot(right), 0.5 - 0.5 * at.dot(up));
        let normal = if is_flat { flat } else { vertex.normal };
        Corner::new(vertex.at, normal, uv)
    });
    solid.quad(corners);
}
