//! Whether a surface can be seen from behind.

use glam::{DVec3, Vec3};
use xxhash_rust::xxh3::xxh3_64;

use super::{Instance, Mesh, World};

impl Mesh {
    /// Whether the triangles bound a volume and face out of it, so that nobody outside ever sees one
    /// from behind before another from the front. Vertices at the same position count as one.
    pub fn is_closed_outward(&self) -> bool {
        // In a closed surface each edge is used in both directions equally often: signed sums of
        // the edges' hashes cancel.
        let mut open = 0u64;
        let mut volume = 0.0;
        let middle = self.bounds.center().as_dvec3();
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|i| self.positions[i as usize]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                open = open.wrapping_add(edge_hash(from, to));
            }
            let [a, b, c]: [DVec3; 3] = [a, b, c].map(|p| p.as_dvec3() - middle);
            volume += a.dot(b.cross(c));
        }
        open == 0 && volume > 0.0
    }
}

impl World {
    /// Whether an instance has triangles that the camera culls from behind with nothing of its own in
    /// front of them.
    pub fn hides_backs(&self, instance: &Instance) -> bool {
        !self.materials[instance.material].double_sided
            && !self.meshes[instance.mesh].is_closed_outward()
    }
}

/// A hash of the edge that changes its sign with the edge's direction.
fn edge_hash(from: Vec3, to: Vec3) -> u64 {
    // Both zeros are one position.
    let [from, to] = [from, to].map(|p| (p + Vec3::ZERO).to_array().map(f32::to_bits));
    let hash = |ends: [[u32; 3]; 2]| xxh3_64(bytemuck::bytes_of(&ends));
    match from.cmp(&to) {
        std::cmp::Ordering::Less => hash([from, to]),
        std::cmp::Ordering::Equal => 0,
        std::cmp::Ordering::Greater => hash([to, from]).wrapping_neg(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Bounds;

    fn mesh(triangles: &[[u32; 3]]) -> Mesh {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let bounds = Bounds::of(positions.iter().copied());
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
    fn vertices_at_one_position_are_one() {
        let mut split = mesh(&OUTWARD);
        split.positions.push(Vec3::new(-0.0, 1.0, 0.0));
        split.triangles[3] = [1, 4, 3];
        assert!(split.is_closed_outward());
    }
}
