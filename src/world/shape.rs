//! Shapes without files: their tessellation into meshes, in object space.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::Mesh;
use crate::{math::Bounds, scene::desc::ShapeDesc};

/// Tessellates `shape` (sizes in meters, as its description says).
///
/// Triangles are counter-clockwise seen from outside; curved sides have smooth normals; texture
/// coordinates run left to right and top to bottom as seen from outside, once around. Tangents
/// stay empty.
pub fn mesh(shape: &ShapeDesc) -> Mesh {
    let mut builder = Builder::default();
    let name = match *shape {
        ShapeDesc::Plane { size } => {
            let (x, z) = (size[0] * 0.5, size[1] * 0.5);
            builder.quad(Vec3::ZERO, Vec3::X * x, Vec3::NEG_Z * z);
            "plane"
        }
        ShapeDesc::Box { size } => {
            builder.cuboid(size * 0.5);
            "box"
        }
        ShapeDesc::Sphere { radius, segments } => {
            builder.sphere(radius, segments.max(3));
            "sphere"
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
            "cylinder"
        }
        ShapeDesc::Cone {
            radius,
            height,
            segments,
        } => {
            let segments = segments.max(3);
            builder.cone_side(radius, height, segments);
            builder.cap(radius, 0.0, segments, Vec3::NEG_Y);
            "cone"
        }
    };
    let mut mesh = builder.mesh;
    mesh.name = name.to_owned();
    mesh.bounds = Bounds::of(mesh.positions.iter().copied());
    mesh
}

/// Direction from the axis at `column / segments` of a turn. Starts at +Z and turns towards +X, so
/// that columns run left to right for someone outside; column `segments` equals column 0 exactly.
fn radial(column: f32, segments: u32) -> Vec3 {
    let (sin, cos) = (TAU * (column / segments as f32).fract()).sin_cos();
    Vec3::new(sin, 0.0, cos)
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

    /// Latitude rows from the top; each pole has one vertex per column, so that the texture
    /// coordinates of its triangles are not sheared.
    fn sphere(&mut self, radius: f32, segments: u32) {
        let rows = (segments / 2).max(2);
        for column in 0..segments {
            let u = (column as f32 + 0.5) / segments as f32;
            self.vertex(Vec3::Y * radius, Vec3::Y, Vec2::new(u, 0.0));
        }
        for row in 1..rows {
            let v = row as f32 / rows as f32;
            let (sin, cos) = (TAU * 0.5 * v).sin_cos();
            for column in 0..=segments {
                let normal = radial(column as f32, segments) * sin + Vec3::Y * cos;
                let u = column as f32 / segments as f32;
                self.vertex(normal * radius, normal.normalize(), Vec2::new(u, v));
            }
        }
        let south = self.mesh.positions.len() as u32;
        for column in 0..segments {
            let u = (column as f32 + 0.5) / segments as f32;
            self.vertex(Vec3::NEG_Y * radius, Vec3::NEG_Y, Vec2::new(u, 1.0));
        }
        let at = |row: u32, column: u32| match row {
            0 => column,
            _ if row == rows => south + column,
            _ => segments + (row - 1) * (segments + 1) + column,
        };
        for row in 0..rows {
            for column in 0..segments {
                let (top, below) = (at(row, column), at(row + 1, column));
                if row + 1 < rows {
                    let right = at(row + 1, column + 1);
                    self.mesh.triangles.push([top, below, right]);
                }
                if row > 0 {
                    let right = if row + 1 < rows { below + 1 } else { below };
                    self.mesh.triangles.push([top, right, top + 1]);
                }
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

    /// One tip vertex per column: its normal is that of the column's middle.
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
mod tests {
    use std::{collections::HashMap, f64::consts::PI};

    use glam::DVec3;

    use super::*;

    fn corners(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> {
        let at = |i: u32| mesh.positions[i as usize].as_dvec3();
        mesh.triangles.iter().map(move |t| t.map(at))
    }

    fn area_and_volume(mesh: &Mesh) -> (f64, f64) {
        corners(mesh).fold((0.0, 0.0), |(area, volume), [a, b, c]| {
            let twice = (b - a).cross(c - a);
            (area + twice.length() / 2.0, volume + a.dot(twice) / 6.0)
        })
    }

    /// How many directed edges have no partner in the other direction.
    fn open_edges(mesh: &Mesh) -> usize {
        let mut edges: HashMap<_, i32> = HashMap::new();
        for [a, b, c] in corners(mesh) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                // +0.0 and -0.0 are the same place.
                let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
                *edges.entry((key(from), key(to))).or_default() += 1;
                *edges.entry((key(to), key(from))).or_default() -= 1;
            }
        }
        edges.values().filter(|n| **n != 0).count() / 2
    }

    fn check(shape: ShapeDesc, area: f64, volume: f64, tolerance: f64) {
        let mesh = mesh(&shape);
        assert_eq!(mesh.normals.len(), mesh.positions.len());
        assert_eq!(mesh.uv0.len(), mesh.positions.len());
        for (t, [a, b, c]) in mesh.triangles.iter().zip(corners(&mesh)) {
            let face = (b - a).cross(c - a);
            assert!(face.length() > 0.0, "{shape:?}: degenerate {t:?}");
            for i in t {
                let normal = mesh.normals[*i as usize];
                assert!((normal.length() - 1.0).abs() < 1e-5, "{shape:?}: {normal}");
                let agrees = normal.as_dvec3().dot(face.normalize());
                assert!(agrees > 0.3, "{shape:?}: normal and winding: {agrees}");
                let uv = mesh.uv0[*i as usize];
                assert!(uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all());
            }
        }
        let (got_area, got_volume) = area_and_volume(&mesh);
        assert!((got_area / area - 1.0).abs() < tolerance, "{got_area}");
        if volume > 0.0 {
            assert_eq!(open_edges(&mesh), 0, "{shape:?}");
            assert!(
                (got_volume / volume - 1.0).abs() < tolerance,
                "{got_volume}"
            );
        } else {
            assert_eq!(open_edges(&mesh), 4);
        }
    }

    #[test]
    fn flat_shapes_are_exact() {
        check(ShapeDesc::Plane { size: [2.0, 3.0] }, 6.0, 0.0, 1e-6);
        let size = Vec3::new(1.0, 2.0, 3.0);
        check(ShapeDesc::Box { size }, 22.0, 6.0, 1e-6);
        let plane = mesh(&ShapeDesc::Plane { size: [1.0, 1.0] });
        assert!(plane.normals.iter().all(|n| *n == Vec3::Y));
    }

    #[test]
    fn curved_shapes_are_closed_and_near_their_closed_form() {
        let (radius, height, segments) = (0.5, 2.0, 256);
        let (r, h) = (0.5_f64, 2.0_f64);
        check(
            ShapeDesc::Sphere { radius, segments },
            4.0 * PI * r * r,
            4.0 / 3.0 * PI * r * r * r,
            1e-3,
        );
        let cylinder = ShapeDesc::Cylinder {
            radius,
            height,
            segments,
        };
        check(cylinder, 2.0 * PI * r * (r + h), PI * r * r * h, 1e-3);
        let cone = ShapeDesc::Cone {
            radius,
            height,
            segments,
        };
        let slope = r.hypot(h);
        check(cone, PI * r * (r + slope), PI * r * r * h / 3.0, 1e-3);
    }

    #[test]
    fn coarsest_curved_shapes_are_closed() {
        let segments = 3;
        for shape in [
            ShapeDesc::Sphere {
                radius: 1.0,
                segments,
            },
            ShapeDesc::Cylinder {
                radius: 1.0,
                height: 1.0,
                segments,
            },
            ShapeDesc::Cone {
                radius: 1.0,
                height: 1.0,
                segments,
            },
        ] {
            let mesh = mesh(&shape);
            assert_eq!(open_edges(&mesh), 0, "{shape:?}");
            assert!(area_and_volume(&mesh).1 > 0.1, "{shape:?}");
        }
    }

    #[test]
    fn texture_runs_left_to_right_seen_from_outside() {
        for shape in [
            ShapeDesc::Sphere {
                radius: 1.0,
                segments: 16,
            },
            ShapeDesc::Cylinder {
                radius: 1.0,
                height: 1.0,
                segments: 16,
            },
            ShapeDesc::Cone {
                radius: 1.0,
                height: 1.0,
                segments: 16,
            },
            ShapeDesc::Box { size: Vec3::ONE },
            ShapeDesc::Plane { size: [1.0, 1.0] },
        ] {
            let mesh = mesh(&shape);
            for t in &mesh.triangles {
                let [a, b, c] = t.map(|i| mesh.uv0[i as usize]);
                // v points down, so a counter-clockwise triangle is clockwise in (u, v).
                assert!((b - a).perp_dot(c - a) < 0.0, "{shape:?}: {a} {b} {c}");
            }
        }
    }
}
