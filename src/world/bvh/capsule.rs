//! Capsules on the CPU, in f64: all points within a radius of a segment, spheres where the segment has no length.
//! `shaders/lib/capsule.wgsl` has the same functions in f32.
//!
//! A point of a capsule's surface has two coordinates in [0, 1]: the place along the meridian from the pole behind
//! the first end to the pole behind the second, by length, and the angle around the axis.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use crate::Mesh;

/// A capsule.
#[derive(Clone, Copy, Debug)]
pub struct Capsule {
    /// First end of the segment.
    pub base: DVec3,
    /// Second end − first end; zero for a sphere.
    pub axis: DVec3,
    /// Radius, above 0.
    pub radius: f64,
}

impl Capsule {
    /// Capsule of a mesh, in object space; `None` where the mesh is of triangles.
    pub fn of_mesh(mesh: &Mesh, index: u32) -> Option<Self> {
        let radius = mesh.capsule_radius_m?.into();
        let [base, end, _] =
            mesh.triangles[index as usize].map(|i| mesh.positions[i as usize].as_dvec3());
        let axis = end - base;
        Some(Self { base, axis, radius })
    }

    /// Distance of a point from the surface, negative inside, and the unit normal there.
    pub fn height(&self, point: DVec3) -> (f64, DVec3) {
        let from_base = point - self.base;
        let along = from_base.dot(self.axis) / self.axis.length_squared().max(1e-300);
        let from_axis = from_base - self.axis * along.clamp(0.0, 1.0);
        let height = from_axis.length() - self.radius;
        (height, from_axis.normalize_or(DVec3::Z))
    }

    /// Where the ray's line enters and leaves the capsule, in lengths of the direction; `None` where it misses.
    pub fn span(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let (axis, dd) = (self.axis, direction.length_squared());
        let from_base = origin - self.base;
        // Seen from the point of the ray nearest to the middle, so that distance costs no precision.
        let shift = (axis * 0.5 - from_base).dot(direction) / dd;
        let near = from_base + direction * shift;
        let (aa, along) = (axis.length_squared(), axis.dot(direction));
        let across = axis.cross(direction);
        let cc = across.length_squared();
        // Times at which the line enters and leaves the infinite cylinder, and the heights there times |axis|².
        let (mut times, mut heights) = ([0.0; 2], [-along * 1e30, along * 1e30]);
        let is_parallel = cc <= aa * dd * 1e-12;
        if !is_parallel {
            let rest = aa * (self.radius.powi(2) * cc - near.dot(across).powi(2));
            if rest < 0.0 {
                return None;
            }
            let middle = axis.dot(near) * along - aa * near.dot(direction);
            times = [-1.0, 1.0].map(|side: f64| (middle + side * rest.sqrt()) / cc);
            heights = times.map(|t| axis.dot(near) + t * along);
        }
        for k in 0..2 {
            if !is_parallel && (0.0..=aa).contains(&heights[k]) {
                continue;
            }
            let end = if heights[k] > aa { axis } else { DVec3::ZERO };
            let from_end = near - end;
            let nearest = -from_end.dot(direction) / dd;
            let apart = (from_end + direction * nearest).length_squared();
            let rest = self.radius.powi(2) - apart;
            if rest < 0.0 {
                return None;
            }
            times[k] = nearest + [-1.0, 1.0][k] * (rest / dd).sqrt();
        }
        Some(times.map(|t| shift + t))
    }

    /// Coordinates of a point on the surface.
    pub fn place(&self, point: DVec3) -> DVec2 {
        let (from_base, length) = (point - self.base, self.axis.length());
        let share = if length > 0.0 {
            (from_base.dot(self.axis) / length.powi(2)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let normal = (from_base - self.axis * share).normalize_or(DVec3::Z);
        let [u, v, w] = self.frame();
        let meridian = normal.dot(w).clamp(-1.0, 1.0).asin() + FRAC_PI_2;
        let along = (share * length + self.radius * meridian) / (length + self.radius * PI);
        let angle = normal.dot(v).atan2(normal.dot(u)) / TAU;
        DVec2::new(along, angle - angle.floor())
    }

    /// Point of the axis nearest to a place on the surface, as a share of the segment, and the unit normal.
    pub fn point(&self, place: DVec2) -> (f64, DVec3) {
        let length = self.axis.length();
        let along = place.x * (length + self.radius * PI) - self.radius * FRAC_PI_2;
        let on_axis = along.clamp(0.0, length);
        let share = if length > 0.0 { on_axis / length } else { 0.0 };
        let (sine, cosine) = ((along - on_axis) / self.radius).sin_cos();
        let (y, x) = (place.y * TAU).sin_cos();
        let [u, v, w] = self.frame();
        (share, (u * x + v * y) * cosine + w * sine)
    }

    /// Orthonormal vectors; the last is along the axis, or along z for a sphere.
    fn frame(&self) -> [DVec3; 3] {
        let w = self.axis.normalize_or(DVec3::Z);
        let (u, v) = w.any_orthonormal_pair();
        [u, v, w]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_the_surface_where_it_is() {
        let base = DVec3::new(1.0, 2.0, 3.0);
        let mut met = 0;
        for axis in [DVec3::ZERO, DVec3::new(0.5, -1.0, 2.0), DVec3::X * 1e-3] {
            let capsule = Capsule {
                base,
                axis,
                radius: 0.3,
            };
            for k in 0..400 {
                // Directions and offsets that fill the neighborhood of the capsule.
                let angle = f64::from(k) * 2.399_963;
                let z = 1.0 - (f64::from(k) + 0.5) / 200.0;
                let across = (1.0 - z * z).sqrt();
                let direction = DVec3::new(across * angle.cos(), across * angle.sin(), z) * 2.5;
                let aim =
                    base + axis * (f64::from(k % 7) / 6.0) + DVec3::Y * (f64::from(k % 5) * 0.1);
                let origin = aim - direction * 40.0;
                let Some(times) = capsule.span(origin, direction) else {
                    let steps =
                        (0..4000).map(|s| origin + direction * (39.0 + f64::from(s) / 2000.0));
                    let least = steps.map(|p| capsule.height(p).0).fold(f64::MAX, f64::min);
                    assert!(least > -1e-6, "{axis} {k}: a miss that is {least} inside");
                    continue;
                };
                met += 1;
                assert!(times[0] <= times[1]);
                for t in times {
                    let point = origin + direction * t;
                    assert!(capsule.height(point).0.abs() < 1e-9, "{axis} {k}");
                    let (share, normal) = capsule.point(capsule.place(point));
                    let again = base + axis * share + normal * capsule.radius;
                    assert!(again.distance(point) < 1e-9, "{axis} {k}: {again} {point}");
                }
            }
        }
        assert!(met > 600, "{met}");
        let along = Capsule {
            base,
            axis: DVec3::Z * 2.0,
            radius: 0.5,
        };
        assert_eq!(
            along.span(base - DVec3::Z * 5.0, DVec3::Z),
            Some([4.5, 7.5])
        );
        assert_eq!(
            along.span(base + DVec3::new(0.6, 0.0, -5.0), DVec3::Z),
            None
        );
    }
}
