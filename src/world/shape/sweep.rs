//! Flat regions moved along curves.

use glam::{DVec2, DVec3};

use super::{
    Fault,
    contour::Column,
    curve::{Curve, first_up, transported},
    region::{EDGE, Region},
    solid::{Corner, Solid, check_size},
};

/// Sine of half of the least angle that two pieces of a curve may make, 12°: a miter there is ten times as long as the
/// profile is wide.
const SHARPEST: f64 = 0.1;

/// How the profile changes along a curve.
#[derive(Clone, Copy, Debug)]
pub struct Along {
    /// Turn at the end, radians.
    pub twist: f64,
    /// Size at the end.
    pub taper: f64,
}

/// A ring of vertices: the profile at a point of the curve.
#[derive(Clone, Copy)]
struct Ring {
    /// Point of the curve.
    center: DVec3,
    /// Directions in space that the profile's x and y become, sheared into the plane of the miter and scaled.
    axes: [DVec3; 2],
    /// Fraction of the curve's length before it.
    share: f64,
}

impl Ring {
    fn point(&self, p: DVec2) -> DVec3 {
        self.center + self.axes[0] * p.x + self.axes[1] * p.y
    }
}

/// Adds the solid that a region passes through when it is moved along a curve; returns the number of the first point
/// of the curve at which the profile is wider than the bend, so that the surface passes through itself.
///
/// # Errors
/// `wrong-curve` where the curve turns back; `shape-too-large`.
pub fn add(
    solid: &mut Solid,
    region: &Region,
    curve: &Curve,
    along: Along,
) -> Result<Option<usize>, Fault> {
    let pieces = curve.pieces();
    check_size(
        2 * region.sides() * (pieces + 1),
        "`segments` of the shape or of its outline",
    )?;
    let rings = rings(curve, along)?;
    let mut crossed = None;
    for [a, b] in region.contours().flat_map(|contour| &contour.sides) {
        for piece in 0..pieces {
            let ends = [piece, piece + 1]
                .map(|ring| [a, b].map(|column| corner(&rings, curve, [piece, ring], column)));
            let [[start_a, start_b], [end_a, end_b]] = ends;
            if (end_a.at - start_a.at).as_dvec3().dot(curve.way(piece)) < 0.0 {
                let point = curve.point_of(piece);
                crossed = Some(crossed.map_or(point, |first: usize| first.min(point)));
            }
            solid.quad([start_a, end_a, end_b, start_b]);
        }
    }
    if !curve.closed {
        add_ends(solid, region, &rings, curve)?;
    }
    Ok(crossed)
}

/// The corner of a piece at one of its rings, with the surface's normal there: the profile's, tilted by twist and
/// taper.
fn corner(rings: &[Ring], curve: &Curve, [piece, ring]: [usize; 2], column: &Column) -> Corner {
    let here = &rings[ring];
    let at = here.point(column.at);
    // Along the surface: through the neighbors where the curve bends smoothly, else within the piece.
    let pieces = curve.pieces();
    let [mut from, mut to] = [piece, piece + 1];
    let (before, after) = match curve.closed {
        true => ((piece + pieces - 1) % pieces, (piece + 1) % pieces),
        false => (piece.saturating_sub(1), (piece + 1).min(pieces - 1)),
    };
    let is_smooth = |other: usize| curve.way(piece).dot(curve.way(other)) > EDGE;
    if ring == piece && before != piece && is_smooth(before) {
        from = before;
    } else if ring == piece + 1 && after != piece && is_smooth(after) {
        to = after + 1;
    }
    let along = (rings[to].point(column.at) - at) + (at - rings[from].point(column.at));
    let across_way = column.normal.perp();
    let across = here.axes[0] * across_way.x + here.axes[1] * across_way.y;
    let mut normal = along.cross(across);
    if normal.length_squared() < 1e-24 * along.length_squared() {
        // At a tip the profile has no size.
        let step = rings[piece + usize::from(ring == piece)];
        let across = step.axes[0] * across_way.x + step.axes[1] * across_way.y;
        normal = along.cross(across);
    }
    Corner::new(at, normal, DVec2::new(column.share, here.share))
}

/// The rings of a curve, one more than it has pieces.
fn rings(curve: &Curve, along: Along) -> Result<Vec<Ring>, Fault> {
    let pieces = curve.pieces();
    let length: f64 = (0..pieces).map(|piece| curve.length(piece)).sum();
    let mut ups = vec![first_up(curve.way(0))];
    for piece in 1..pieces {
        ups.push(transported(
            ups[piece - 1],
            curve.way(piece - 1),
            curve.way(piece),
        ));
    }
    // The turn of the frame after a whole round is spread along the curve.
    let mut excess = 0.0;
    if curve.closed {
        let back = transported(ups[pieces - 1], curve.way(pieces - 1), curve.way(0));
        let way = curve.way(0);
        excess = back.cross(ups[0]).dot(way).atan2(back.dot(ups[0]));
    }
    let mut before = 0.0;
    let mut rings = Vec::with_capacity(pieces + 1);
    for ring in 0..=pieces {
        let (last, next) = match curve.closed {
            true => ((ring + pieces - 1) % pieces, ring % pieces),
            false => (ring.saturating_sub(1), ring.min(pieces - 1)),
        };
        let plane = (curve.way(last) + curve.way(next)) / 2.0;
        if plane.length() < SHARPEST {
            let point = curve.point_of(ring.min(pieces - 1)) + 1;
            let message = format!("the curve turns back on itself near its point {point}");
            let help = "a bend of more than 168° has no place for a corner; move the point, or add one beside it";
            return Err(Fault::new("wrong-curve", message).help(help));
        }
        // The last ring of a closed curve is the first one.
        let (piece, share) = if ring == pieces {
            (last, 1.0)
        } else {
            (next, before / length)
        };
        let way = curve.way(piece);
        let turn = along.twist * share + excess * share;
        let size = 1.0 + (along.taper - 1.0) * share;
        let up = ups[piece];
        let right = way.cross(up);
        let (sin, cos) = turn.sin_cos();
        let axes = [right * cos - up * sin, right * sin + up * cos].map(|axis| {
            // Along the piece onto the plane of the miter.
            (axis - way * (axis.dot(plane) / way.dot(plane))) * size
        });
        rings.push(Ring {
            center: curve.points[ring % curve.points.len()],
            axes,
            share,
        });
        before += curve.length(ring.min(pieces - 1));
    }
    if curve.closed {
        rings[pieces] = Ring {
            share: 1.0,
            ..rings[0]
        };
    }
    Ok(rings)
}

/// Adds flat ends.
fn add_ends(
    solid: &mut Solid,
    region: &Region,
    rings: &[Ring],
    curve: &Curve,
) -> Result<(), Fault> {
    let [low, high] = region.bounds();
    let last = rings.len() - 1;
    for corners in region.fill(&region.places())? {
        for (ring, way) in [(0, -curve.way(0)), (last, curve.way(last - 1))] {
            let mut face = corners.map(|place| {
                let uv = (place - low) / (high - low);
                // Seen from outside, right is the profile's right at the start.
                let u = if ring == 0 { uv.x } else { 1.0 - uv.x };
                Corner::new(rings[ring].point(place), way, DVec2::new(u, 1.0 - uv.y))
            });
            if ring != 0 {
                face.reverse();
            }
            solid.triangle(face);
        }
    }
    Ok(())
}
