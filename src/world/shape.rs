//! Shapes without files: their tessellation into meshes, in object space.

mod boolean;
mod contour;
pub(crate) mod crossing;
mod crossings;
mod curve;
mod displaced;
mod extrude;
mod fault;
mod flatten;
pub mod heightfield;
mod inset;
mod lathe;
mod made;
mod near_faces;
mod numbers;
mod outlined;
mod region;
mod rounded_box;
mod solid;
mod supplies;
mod svg;
mod sweep;
pub mod text;
mod turn;

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::{Mesh, Round};
use reflet_base::math::Bounds;
use reflet_scene::desc::{LatheSource, ShapeDesc};

pub use self::{curve::Curve, fault::Fault, made::Made, supplies::MOST_WORK, supplies::Supplies};

/// Tessellates `shape` (sizes in meters, as its description says); a height field gives an empty mesh, see
/// [`heightfield::mesh`]. `supplies` has the files that
/// [`ShapeDesc::files`] names, and work that is spent.
///
/// Triangles are counter-clockwise seen from outside; curved sides have smooth normals; texture
/// coordinates run left to right and top to bottom as seen from outside, once around. Tangents
/// stay empty.
///
/// # Errors
/// The same as for outlines, and `shapes-too-large` past the budget of work.
pub fn make(shape: &ShapeDesc, supplies: &Supplies) -> Result<Made, Fault> {
    let mut made = match outlined::make(shape, supplies)? {
        Some(made) => made,
        None => Made::from(simple(shape)),
    };
    supplies.spend(made.mesh.triangles.len())?;
    made.mesh.bounds = Bounds::around(made.mesh.positions.iter().copied());
    Ok(made)
}

/// Mesh of a shape that is described by numbers alone, without bounds.
fn simple(shape: &ShapeDesc) -> Mesh {
    let mut builder = Builder::default();
    match *shape {
        ShapeDesc::Plane { size } => {
            let (x, z) = (size[0] * 0.5, size[1] * 0.5);
            builder.quad(Vec3::ZERO, Vec3::X * x, Vec3::NEG_Z * z);
        }
        ShapeDesc::Box { size, .. } => builder.cuboid(size * 0.5),
        ShapeDesc::Sphere { radius, segments } => {
            builder.mesh.round = segments.is_none().then_some(Round {
                ends: [Vec3::ZERO; 2],
                radius_m: radius,
            });
            let segments = segments.unwrap_or(128);
            let rows = (segments / 2).max(2);
            let row = |row: u32| Row::new(row as f32 / rows as f32, 0.0);
            builder.round_ends(radius, &(0..=rows).map(row).collect::<Vec<_>>(), segments);
        }
        ShapeDesc::Cylinder {
            radius,
            height,
            segments,
        } => {
            let segments = segments.max(3);
            builder.cylinder_side(radius, height, segments);
            builder.cap(radius, height, segments, Vec3::Y);
            builder.cap(radius, 0.0, segments, Vec3::NEG_Y);
        }
        ShapeDesc::Cone {
            radius,
            height,
            segments,
        } => {
            let segments = segments.max(3);
            builder.cone_side(radius, height, segments);
            builder.cap(radius, 0.0, segments, Vec3::NEG_Y);
        }
        ShapeDesc::Disk { radius, segments } => builder.cap(radius, 0.0, segments.max(3), Vec3::Y),
        ShapeDesc::Torus {
            radius,
            tube_radius,
            segments,
            ..
        } => builder.torus(radius, tube_radius, segments.max(3)),
        ShapeDesc::Lathe {
            source: LatheSource::Points(ref points),
            segments,
            ..
        } => lathe::add(&mut builder.mesh, points, segments.max(3)),
        ShapeDesc::Capsule {
            radius,
            height,
            segments,
        } => {
            builder.mesh.round = segments.is_none().then_some(Round {
                ends: [radius, (height - radius).max(radius)].map(|y| Vec3::Y * y),
                radius_m: radius,
            });
            let segments = segments.unwrap_or(64);
            let rows = capsule_rows(radius, height, segments);
            builder.round_ends(radius, &rows, segments);
        }
        ShapeDesc::Mesh { .. } => builder.mesh = numbers::mesh(shape),
        // The loader makes the mesh of a height field, as it reads the image; `outlined` makes the others.
        ShapeDesc::Heightfield { .. }
        | ShapeDesc::Lathe { .. }
        | ShapeDesc::Extrude { .. }
        | ShapeDesc::Sweep { .. }
        | ShapeDesc::Text { .. }
        | ShapeDesc::Union { .. }
        | ShapeDesc::Difference { .. }
        | ShapeDesc::Intersection { .. }
        | ShapeDesc::Displaced { .. } => {}
    }
    Mesh {
        name: shape.name().to_owned(),
        ..builder.mesh
    }
}

/// Direction from the axis at `column / segments` of a turn. Starts at +Z and turns towards +X, so
/// that columns run left to right for someone outside; column `segments` equals column 0 exactly.
fn radial(column: f32, segments: u32) -> Vec3 {
    let (sin, cos) = (TAU * (column / segments as f32).fract()).sin_cos();
    Vec3::new(sin, 0.0, cos)
}

/// A row of vertices of a body with round ends.
struct Row {
    /// Polar angle as a fraction of half a turn: 0 at the upper pole, 1 at the lower one.
    turn: f32,
    /// Height of the center of the row's sphere, meters.
    center: f32,
    /// Texture coordinate v of the row.
    v: f32,
}

impl Row {
    fn new(turn: f32, center: f32) -> Self {
        let v = turn;
        Self { turn, center, v }
    }
}

/// Rows of two half spheres, with texture coordinates in proportion to the distance along the surface.
fn capsule_rows(radius: f32, height: f32, segments: u32) -> Vec<Row> {
    let quarter = (segments / 4).max(1);
    let (arc, side) = (TAU * 0.25 * radius, (height - 2.0 * radius).max(0.0));
    let whole = 2.0 * arc + side;
    let row = |half: u32, step: u32| {
        let share = step as f32 / quarter as f32;
        let way = half as f32 * (arc + side) + share * arc;
        Row {
            turn: 0.5 * (half as f32 + share),
            center: if half == 0 { height - radius } else { radius },
            v: (way / whole).min(1.0),
        }
    };
    let steps = |half| (0..=quarter).map(move |step| row(half, step));
    // Without a straight side both half spheres share the row at the equator.
    let skipped = usize::from(side == 0.0);
    steps(0).chain(steps(1).skip(skipped)).collect()
}

#[derive(Default)]
struct Builder {
    mesh: Mesh,
}

impl Builder {
    fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        let index = self.mesh.positions.len() as u32;
        self.mesh.positions.push(position);
        self.mesh.normals.push(normal);
        self.mesh.uv0.push(uv);
        index
    }

    /// A rectangle around `center`, spanned by half its width and half its height.
    fn quad(&mut self, center: Vec3, right: Vec3, up: Vec3) {
        let normal = right.cross(up).normalize();
        let [a, b, c, d] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let uv = Vec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y);
            self.vertex(center + right * x + up * y, normal, uv)
        });
        self.mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }

    fn cuboid(&mut self, half: Vec3) {
        for (normal, right, up) in [
            (Vec3::X, Vec3::NEG_Z, Vec3::Y),
            (Vec3::NEG_X, Vec3::Z, Vec3::Y),
            (Vec3::Y, Vec3::X, Vec3::NEG_Z),
            (Vec3::NEG_Y, Vec3::X, Vec3::Z),
            (Vec3::Z, Vec3::X, Vec3::Y),
            (Vec3::NEG_Z, Vec3::NEG_X, Vec3::Y),
        ] {
            self.quad(normal * half, right * half, up * half);
        }
    }

    /// Latitude rows from the top, the first and the last at the poles; each pole has one vertex per
    /// column, so that the texture coordinates of its triangles are not sheared.
    fn round_ends(&mut self, radius: f32, rows: &[Row], segments: u32) {
        let segments = segments.max(3);
        let last = rows.len() as u32 - 1;
        let mut starts = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            starts.push(self.mesh.positions.len() as u32);
            let center = Vec3::Y * row.center;
            let is_pole = index == 0 || index as u32 == last;
            let columns = if is_pole { segments } else { segments + 1 };
            for column in 0..columns {
                let column = column as f32;
                if is_pole {
                    let normal = if index == 0 { Vec3::Y } else { Vec3::NEG_Y };
                    let uv = Vec2::new((column + 0.5) / segments as f32, row.v);
                    self.vertex(center + normal * radius, normal, uv);
                    continue;
                }
                let (sin, cos) = (TAU * 0.5 * row.turn).sin_cos();
                let normal = radial(column, segments) * sin + Vec3::Y * cos;
                let uv = Vec2::new(column / segments as f32, row.v);
                self.vertex(center + normal * radius, normal.normalize(), uv);
            }
        }
        for row in 0..last {
            let [start, next] = [starts[row as usize], starts[row as usize + 1]];
            for column in 0..segments {
                let (top, below) = (start + column, next + column);
                if row + 1 < last {
                    self.mesh.triangles.push([top, below, below + 1]);
                }
                if row > 0 {
                    let right = if row + 1 < last { below + 1 } else { below };
                    self.mesh.triangles.push([top, right, top + 1]);
                }
            }
        }
    }

    /// Rows around the tube from its inner side over the top; columns around the axis.
    fn torus(&mut self, radius: f32, tube_radius: f32, segments: u32) {
        let rows = (segments / 2).max(3);
        for row in 0..=rows {
            let v = row as f32 / rows as f32;
            // The last row is exactly where the first one is.
            let (sin, cos) = (TAU * (row % rows) as f32 / rows as f32).sin_cos();
            for column in 0..=segments {
                let out = radial(column as f32, segments);
                let normal = Vec3::Y * sin - out * cos;
                let uv = Vec2::new(column as f32 / segments as f32, v);
                self.vertex(out * radius + normal * tube_radius, normal.normalize(), uv);
            }
        }
        let across = segments + 1;
        for row in 0..rows {
            for column in 0..segments {
                let (top, below) = (row * across + column, (row + 1) * across + column);
                let quad = [[top, below, below + 1], [top, below + 1, top + 1]];
                self.mesh.triangles.extend(quad);
            }
        }
    }

    fn cylinder_side(&mut self, radius: f32, height: f32, segments: u32) {
        let first = self.mesh.positions.len() as u32;
        for column in 0..=segments {
            let normal = radial(column as f32, segments);
            let u = column as f32 / segments as f32;
            let foot = normal * radius;
            self.vertex(foot + Vec3::Y * height, normal, Vec2::new(u, 0.0));
            self.vertex(foot, normal, Vec2::new(u, 1.0));
        }
        for column in 0..segments {
            let top = first + 2 * column;
            self.mesh
                .triangles
                .extend([[top, top + 1, top + 3], [top, top + 3, top + 2]]);
        }
    }

    /// One tip vertex per column, with the normal of the column's middle.
    fn cone_side(&mut self, radius: f32, height: f32, segments: u32) {
        // The side rises by `height` over `radius`; its normal is perpendicular to that slope.
        let normal_at =
            |column: f32| (radial(column, segments) * height + Vec3::Y * radius).normalize();
        let first = self.mesh.positions.len() as u32;
        for column in 0..=segments {
            let foot = radial(column as f32, segments) * radius;
            let u = column as f32 / segments as f32;
            self.vertex(foot, normal_at(column as f32), Vec2::new(u, 1.0));
        }
        for column in 0..segments {
            let middle = column as f32 + 0.5;
            let uv = Vec2::new(middle / segments as f32, 0.0);
            let tip = self.vertex(Vec3::Y * height, normal_at(middle), uv);
            let foot = first + column;
            self.mesh.triangles.push([tip, foot, foot + 1]);
        }
    }

    /// A disc at height `y` that faces `normal`, up or down.
    fn cap(&mut self, radius: f32, y: f32, segments: u32, normal: Vec3) {
        let center = Vec3::Y * y;
        let middle = self.vertex(center, normal, Vec2::splat(0.5));
        for column in 0..segments {
            let rim = radial(column as f32, segments);
            let uv = Vec2::new(0.5 + 0.5 * rim.x, 0.5 + 0.5 * rim.z * normal.y);
            self.vertex(center + rim * radius, normal, uv);
        }
        for column in 0..segments {
            let (a, b) = (middle + 1 + column, middle + 1 + (column + 1) % segments);
            self.mesh.triangles.push(if normal.y > 0.0 {
                [middle, a, b]
            } else {
                [middle, b, a]
            });
        }
    }
}

#[cfg(test)]
mod tests;
