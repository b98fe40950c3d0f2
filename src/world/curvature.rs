//! Curvature of a mesh as a mirror: whether it may show things larger than a flat mirror would.

use glam::Vec3;
use rayon::prelude::*;

use super::Mesh;

/// Curvature of a mesh, seen from its front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// All triangles are in one plane, and all normals are parallel.
    Flat,
    /// No vertex is in front of the plane of a triangle, and normals never converge.
    Convex,
    /// Any other shape, and shapes that take too long to test.
    Other,
}

/// Maximum number of pairs of a triangle and a vertex that are tested; meshes with more count as [`Curvature::Other`].
const MAX_PAIRS: usize = 1 << 30;
/// Height over a plane that is lost in rounding, as a fraction of the diagonal of the mesh's bounds.
const FLAT: f32 = 1e-5;
/// Curvature by which normals may converge, as a multiple of the inverse diagonal: a mirror so hollow magnifies what
/// is as far away as it is large by a thousandth or two.
const HOLLOW: f32 = 1e-3;

impl Mesh {
    /// Curvature of the mesh at rest, found once.
    pub fn curvature(&self) -> Curvature {
        *self.curvature.get_or_init(|| self.find_curvature())
    }

    fn find_curvature(&self) -> Curvature {
        if self.capsule_radius_m.is_some() {
            // Without normals of their own, capsules are shaded round.
            return match self.normals.is_empty() {
                true => Curvature::Convex,
                false => Curvature::Other,
            };
        }
        let diagonal = self.bounds.diagonal();
        if self.triangles.len().saturating_mul(self.positions.len()) > MAX_PAIRS
            || !(self.triangles.par_iter()).all(|t| self.diverges(*t, diagonal))
        {
            return Curvature::Other;
        }
        let rounding = FLAT * diagonal;
        if !(self.triangles.par_iter()).all(|t| self.heights_over(*t)[1] <= rounding) {
            return Curvature::Other;
        }
        // One triangle with an area tells whether all vertices are in a plane.
        let mut areas = (self.triangles.iter()).filter(|t| self.normal_of(**t) != Vec3::ZERO);
        let lowest = areas.next().map_or(0.0, |t| self.heights_over(*t)[0]);
        match lowest >= -rounding && self.has_one_normal() {
            true => Curvature::Flat,
            false => Curvature::Convex,
        }
    }

    /// Least and greatest height of a vertex over the plane of a triangle, meters; 0 where it has no area.
    fn heights_over(&self, triangle: [u32; 3]) -> [f32; 2] {
        let normal = self.normal_of(triangle);
        let start = self.positions[triangle[0] as usize];
        let heights = self.positions.iter().map(|p| normal.dot(*p - start));
        heights.fold([0.0f32; 2], |[low, high], h| [low.min(h), high.max(h)])
    }

    /// Unit normal of a triangle; zero where it has no area.
    fn normal_of(&self, triangle: [u32; 3]) -> Vec3 {
        let [a, b, c] = triangle.map(|i| self.positions[i as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// Whether the normals that are interpolated over a triangle do not converge in any direction: the symmetric part
    /// of their derivative, which bends wave fronts as the curvature of a mirror does, has no negative eigenvalue.
    fn diverges(&self, triangle: [u32; 3], diagonal: f32) -> bool {
        let [p, q, r] = triangle.map(|i| self.positions[i as usize].as_dvec3());
        let corner = |i: u32| self.normals.get(i as usize).map(|n| n.as_dvec3());
        let [Some(n), Some(m), Some(o)] = triangle.map(corner) else {
            return true;
        };
        let (along, across, of_along, of_across) = (q - p, r - p, m - n, o - n);
        // A form that is not negative stays so with this much of the metric added.
        let hollow = f64::from(HOLLOW / diagonal.max(f32::MIN_POSITIVE));
        let a = along.dot(of_along) + hollow * along.length_squared();
        let c = across.dot(of_across) + hollow * across.length_squared();
        let b = 0.5 * (along.dot(of_across) + across.dot(of_along)) + hollow * along.dot(across);
        a >= 0.0 && c >= 0.0 && a * c >= b * b * (1.0 - 1e-9)
    }

    /// Whether all vertices have the same normal.
    fn has_one_normal(&self) -> bool {
        let first = self.normals.first().copied().unwrap_or(Vec3::Y);
        self.normals.iter().all(|n| n.dot(first) > 1.0 - FLAT)
    }

    /// Whether a mirror of this shape may show something larger than a flat mirror at the same place.
    pub fn may_magnify(&self, is_double_sided: bool) -> bool {
        match self.curvature() {
            _ if self.deformation.is_some() => true,
            Curvature::Flat => false,
            // The back of a convex surface is hollow, and seen where the surface is open.
            Curvature::Convex => is_double_sided && !self.is_closed_outward(),
            Curvature::Other => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_base::math::Bounds;

    /// A square patch of a surface over the XZ plane, with these heights and slopes; triangles face up.
    fn patch(height: impl Fn(f32, f32) -> f32, slopes: impl Fn(f32, f32) -> [f32; 2]) -> Mesh {
        const SIDE: u32 = 9;
        let mut mesh = Mesh::default();
        for row in 0..SIDE {
            for column in 0..SIDE {
                let [x, z] = [column, row].map(|i| i as f32 / (SIDE - 1) as f32 - 0.5);
                mesh.positions.push(Vec3::new(x, height(x, z), z));
                let [dx, dz] = slopes(x, z);
                mesh.normals.push(Vec3::new(-dx, 1.0, -dz).normalize());
            }
        }
        for row in 0..SIDE - 1 {
            for column in 0..SIDE - 1 {
                let at = row * SIDE + column;
                mesh.triangles.push([at, at + SIDE, at + 1]);
                mesh.triangles.push([at + 1, at + SIDE, at + SIDE + 1]);
            }
        }
        mesh.bounds = Bounds::around(mesh.positions.iter().copied());
        mesh
    }

    #[test]
    fn shapes_are_told_by_their_triangles_and_by_their_normals() {
        let plane = patch(|_, _| 0.0, |_, _| [0.0; 2]);
        assert_eq!(plane.curvature(), Curvature::Flat);
        assert!(!plane.may_magnify(true));
        let bulge = patch(|x, z| -x * x - z * z, |x, z| [-2.0 * x, -2.0 * z]);
        assert_eq!(bulge.curvature(), Curvature::Convex);
        assert!(!bulge.may_magnify(false));
        assert!(bulge.may_magnify(true), "its back is hollow");
        let bowl = patch(|x, z| x * x + z * z, |x, z| [2.0 * x, 2.0 * z]);
        assert_eq!(bowl.curvature(), Curvature::Other);
        let saddle = patch(|x, z| z * z - x * x, |x, z| [-2.0 * x, 2.0 * z]);
        assert_eq!(saddle.curvature(), Curvature::Other);
        let bent = patch(|_, _| 0.0, |x, _| [2.0 * x, 0.0]);
        assert_eq!(bent.curvature(), Curvature::Other, "normals that converge");
        let bent = patch(|_, _| 0.0, |x, _| [-2.0 * x, 0.0]);
        assert_eq!(bent.curvature(), Curvature::Convex, "normals that diverge");
    }

    #[test]
    fn faces_without_normals_of_their_own_are_a_hull_or_not() {
        let mut faceted = patch(|x, _| x.abs(), |_, _| [0.0; 2]);
        faceted.normals.clear();
        assert_eq!(faceted.curvature(), Curvature::Other, "a valley");
        let mut ridge = patch(|x, _| -x.abs(), |_, _| [0.0; 2]);
        ridge.normals.clear();
        assert_eq!(ridge.curvature(), Curvature::Convex, "a ridge");
    }
}
