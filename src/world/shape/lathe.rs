//! Outlines turned around the axis Y.

use glam::{Vec2, Vec3};

use super::{radial, region};
use crate::Mesh;

/// Cosine of the bend between two pieces, 40°, from which on their normals are not smoothed.
const EDGE: f32 = region::EDGE as f32;

/// Adds the surface of revolution of an outline, with a row of quads for each of its pieces. Points on the axis
/// make triangles.
pub(super) fn add(mesh: &mut Mesh, points: &[[f32; 2]], segments: u32) {
    let points: Vec<Vec2> = points
        .iter()
        .map(|point| Vec2::from_array(*point))
        .collect();
    let pieces: Vec<Vec2> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
    // Normals point to the right of the outline's direction.
    let normals: Vec<Vec2> = (pieces.iter())
        .map(|way| Vec2::new(way.y, -way.x).normalize())
        .collect();
    let whole: f32 = pieces.iter().map(|way| way.length()).sum();
    let joined = |piece: usize, other: Option<usize>| {
        let (own, other) = (normals[piece], other.and_then(|other| normals.get(other)));
        let other = other.filter(|other| own.dot(**other) > EDGE);
        other.map_or(own, |other| (own + other).normalize())
    };
    let mut way = 0.0;
    for (piece, pair) in points.windows(2).enumerate() {
        let length = pieces[piece].length();
        let ends = [
            (pair[0], joined(piece, piece.checked_sub(1)), way / whole),
            (
                pair[1],
                joined(piece, Some(piece + 1)),
                (way + length) / whole,
            ),
        ];
        way += length;
        add_piece(mesh, ends, segments);
    }
}

/// Adds one piece: its lower and its upper point, each with its normal and its fraction of the outline's length.
fn add_piece(mesh: &mut Mesh, ends: [(Vec2, Vec2, f32); 2], segments: u32) {
    let first = mesh.positions.len() as u32;
    for column in 0..=segments {
        // A corner on the axis is in the middle of its triangle's base.
        for (point, normal, share) in ends {
            let middle = if point.x == 0.0 { 0.5 } else { 0.0 };
            let column = (column as f32 + middle).min(segments as f32);
            let out = radial(column, segments);
            let place = |v: Vec2| out * v.x + Vec3::Y * v.y;
            mesh.positions.push(place(point));
            mesh.normals.push(place(normal).normalize());
            mesh.uv0
                .push(Vec2::new(column / segments as f32, 1.0 - share));
        }
    }
    let [(low, ..), (high, ..)] = ends;
    for column in 0..segments {
        let (low_left, high_left) = (first + 2 * column, first + 2 * column + 1);
        let (low_right, high_right) = (low_left + 2, high_left + 2);
        if low.x > 0.0 {
            mesh.triangles.push([high_left, low_left, low_right]);
        }
        if high.x > 0.0 {
            let foot = if low.x > 0.0 { low_right } else { low_left };
            mesh.triangles.push([high_left, foot, high_right]);
        }
    }
}
