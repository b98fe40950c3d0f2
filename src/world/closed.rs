//! Test whether a mesh is closed, so that its back faces are never visible from outside.

use glam::{DVec3, Vec3};
use xxhash_rust::xxh3::xxh3_64;

use super::{Instance, Mesh, World};

/// Largest total rim length of holes that are ignored, as a fraction of the diagonal of the mesh's bounds: scans
/// have small holes, and a view into one is a few pixels wide.
const SMALL_HOLES: f32 = 0.05;
/// Maximum number of triangles of a mesh that is searched for rims, which takes 16 bytes an edge.
const MAX_SEARCHED: usize = 1 << 21;

impl Mesh {
    /// Whether the triangles bound a volume and face out of it, except for small holes: then every ray from outside
    /// meets a front face first. Vertices at the same position count as one.
    pub fn is_closed_outward(&self) -> bool {
        *self.closed.get_or_init(|| {
            if self.capsule_radius_m.is_some() {
                return true;
            }
            self.volume() > 0.0
                && (self.edges_cancel()
                    || self.triangles.len() <= MAX_SEARCHED
                        && self.rim_length() <= SMALL_HOLES * self.bounds.diagonal())
        })
    }

    /// Six times the volume that a closed surface bounds; negative where it faces inward.
    fn volume(&self) -> f64 {
        let middle = self.bounds.center().as_dvec3();
        let corners = |t: &[u32; 3]| t.map(|i| self.positions[i as usize].as_dvec3() - middle);
        let signed = self.triangles.iter().map(corners);
        signed.map(|[a, b, c]: [DVec3; 3]| a.dot(b.cross(c))).sum()
    }

    /// Every edge, as its two ends in the triangle's direction.
    fn edges(&self) -> impl Iterator<Item = [Vec3; 2]> {
        self.triangles.iter().flat_map(|triangle| {
            let [a, b, c] = triangle.map(|i| self.positions[i as usize]);
            [[a, b], [b, c], [c, a]]
        })
    }

    /// Whether the triangles bound a volume, from whichever side: each edge is used in both directions equally often,
    /// so that signed sums of the edges' hashes cancel. Vertices at the same position count as one.
    pub fn edges_cancel(&self) -> bool {
        let signed = self.edges().map(|[a, b]| {
            let (hash, sign) = edge_hash(a, b);
            if sign < 0 { hash.wrapping_neg() } else { hash }
        });
        signed.fold(0, u64::wrapping_add) == 0
    }

    /// Total length of the edges that are used more often in one direction than in the other.
    fn rim_length(&self) -> f32 {
        let mut edges: Vec<(u64, i8, f32)> = (self.edges())
            .map(|[a, b]| {
                let (hash, sign) = edge_hash(a, b);
                (hash, sign, a.distance(b))
            })
            .collect();
        edges.sort_unstable_by_key(|edge| edge.0);
        let lengths = edges.chunk_by(|a, b| a.0 == b.0).map(|same| {
            let open: i32 = same.iter().map(|edge| i32::from(edge.1)).sum();
            open.unsigned_abs() as f32 * same[0].2
        });
        lengths.sum()
    }
}

impl World {
    /// Whether an instance may have back faces that the camera culls without a front face of the instance before
    /// them.
    pub fn hides_backs(&self, instance: &Instance) -> bool {
        !self.materials[instance.material].double_sided
            && !self.meshes[instance.mesh].is_closed_outward()
    }

    /// Whether an instance has triangles that reflections show and the camera does not.
    pub fn hides_from_camera(&self, instance: &Instance) -> bool {
        instance.shown.in_reflections && (!instance.shown.visible || self.hides_backs(instance))
    }
}

/// Hash of an edge, and 1 or -1 by its direction; both 0 for an edge between equal positions.
fn edge_hash(from: Vec3, to: Vec3) -> (u64, i8) {
    // 0.0 and -0.0 are the same position.
    let [from, to] = [from, to].map(|p| (p + Vec3::ZERO).to_array().map(f32::to_bits));
    let hash = |ends: [[u32; 3]; 2]| xxh3_64(bytemuck::bytes_of(&ends));
    match from.cmp(&to) {
        std::cmp::Ordering::Less => (hash([from, to]), 1),
        std::cmp::Ordering::Equal => (0, 0),
        std::cmp::Ordering::Greater => (hash([to, from]), -1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_base::math::Bounds;

    fn mesh(triangles: &[[u32; 3]]) -> Mesh {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let bounds = Bounds::around(positions.iter().copied());
        Mesh {
            normals: vec![Vec3::Y; 4],
            uv0: vec![glam::Vec2::ZERO; 4],
            triangles: triangles.to_vec(),
            bounds,
            positions,
            ..Mesh::default()
        }
    }

    const OUTWARD: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    #[test]
    fn only_whole_surfaces_that_face_outward_hide_their_backs() {
        assert!(mesh(&OUTWARD).is_closed_outward());
        assert!(!mesh(&OUTWARD[..3]).is_closed_outward(), "a hole");
        let inward = OUTWARD.map(|[a, b, c]| [a, c, b]);
        assert!(!mesh(&inward).is_closed_outward(), "a room");
        let mut one_flipped = OUTWARD;
        one_flipped[3] = [1, 3, 2];
        assert!(!mesh(&one_flipped).is_closed_outward());
    }

    #[test]
    fn a_small_hole_does_not_count_and_a_large_one_does() {
        let with_cap = |angle: f32| {
            // Rings of a sphere; leaving out the cap at its pole makes a hole.
            let rings = 64;
            let mut ball = Mesh::default();
            for ring in 0..=rings {
                let polar = angle + (std::f32::consts::PI - angle) * ring as f32 / rings as f32;
                for step in 0..rings {
                    let around = std::f32::consts::TAU * step as f32 / rings as f32;
                    let (sin, cos) = polar.sin_cos();
                    let south = ring == rings; // one position
                    let radius = if south { 0.0 } else { sin };
                    let at = Vec3::new(radius * around.sin(), cos, radius * around.cos());
                    ball.positions.push(at);
                }
            }
            for ring in 0..rings {
                for step in 0..rings {
                    let at = |ring: u32, step: u32| ring * rings + step % rings;
                    let [a, b] = [at(ring, step), at(ring, step + 1)];
                    let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
                    ball.triangles.extend([[a, c, d], [a, d, b]]);
                }
            }
            ball.bounds = Bounds::around(ball.positions.iter().copied());
            ball.is_closed_outward()
        };
        assert!(with_cap(0.02), "a rim of 4 % of the diagonal");
        assert!(!with_cap(0.1), "of 18 %");
    }

    #[test]
    fn vertices_at_one_position_are_one() {
        let mut split = mesh(&OUTWARD);
        split.positions.push(Vec3::new(-0.0, 1.0, 0.0));
        split.triangles[3] = [1, 4, 3];
        assert!(split.is_closed_outward());
    }
}
