//! Sums of the faces around a vertex that bend little from a given face.

use glam::DVec3;

use super::region::EDGE;

/// Largest number of faces that are compared one by one: up to it, that takes less time than a tree.
const FEW: usize = 32;

/// The faces around a vertex, in a tree over their directions where there are many: all queries of a fan of n triangles
/// take about n · √n steps, of a flat fan or a cone n · log n, in place of n².
pub struct NearFaces {
    faces: Vec<Face>,
    /// Nodes of the tree, root first; none where there are few faces.
    nodes: Vec<Node>,
}

struct Face {
    direction: DVec3,
    /// Twice the area times the normal.
    vector: DVec3,
}

/// Faces of neighboring directions.
struct Node {
    center: DVec3,
    half_size: DVec3,
    /// Sum of the vectors.
    sum: DVec3,
    start: usize,
    end: usize,
    /// Index of the second child, the first follows its parent; `None` at leaves.
    second: Option<usize>,
}

impl NearFaces {
    /// Faces by twice their areas times their normals.
    pub fn new(vectors: impl Iterator<Item = DVec3>) -> Self {
        let face = |vector: DVec3| Face {
            direction: vector.normalize_or_zero(),
            vector,
        };
        let mut all = Self {
            faces: vectors.map(face).collect(),
            nodes: Vec::new(),
        };
        if all.faces.len() > FEW {
            all.split(0, all.faces.len());
        }
        all
    }

    fn split(&mut self, start: usize, end: usize) {
        let faces = &mut self.faces[start..end];
        let first = faces[0].direction;
        let (min, max) = faces.iter().fold((first, first), |(min, max), face| {
            (min.min(face.direction), max.max(face.direction))
        });
        let index = self.nodes.len();
        self.nodes.push(Node {
            center: (min + max) / 2.0,
            half_size: (max - min) / 2.0,
            sum: faces.iter().map(|face| face.vector).sum(),
            start,
            end,
            second: None,
        });
        let middle = faces.len() / 2;
        // Faces of one direction are taken or left together.
        if middle < FEW / 2 || max == min {
            return;
        }
        let axis = (max - min).max_position();
        faces.select_nth_unstable_by(middle, |a, b| {
            a.direction[axis].total_cmp(&b.direction[axis])
        });
        self.split(start, start + middle);
        self.nodes[index].second = Some(self.nodes.len());
        self.split(start + middle, end);
    }

    /// Sum of the vectors of the faces that bend by less than 40° from a direction.
    pub fn sum(&self, direction: DVec3) -> DVec3 {
        if self.nodes.is_empty() {
            return sum_near(&self.faces, direction);
        }
        let mut sum = DVec3::ZERO;
        let mut open = vec![0];
        while let Some(index) = open.pop() {
            let node = &self.nodes[index];
            let middle = node.center.dot(direction);
            let reach = node.half_size.dot(direction.abs());
            if middle - reach > EDGE {
                sum += node.sum;
            } else if middle + reach > EDGE {
                match node.second {
                    Some(second) => open.extend([second, index + 1]),
                    None => sum += sum_near(&self.faces[node.start..node.end], direction),
                }
            }
        }
        sum
    }
}

fn sum_near(faces: &[Face], direction: DVec3) -> DVec3 {
    let near = faces.iter().filter(|f| f.direction.dot(direction) > EDGE);
    near.map(|face| face.vector).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_base::pcg::Pcg;

    #[test]
    fn the_tree_sums_what_a_comparison_of_all_pairs_sums() {
        let mut random = Pcg::new(3);
        let mut point = || DVec3::from([0; 3].map(|_| random.unit() - 0.5));
        let mut vectors: Vec<DVec3> = (0..500).map(|_| point()).collect();
        vectors.extend([DVec3::ZERO; 40]);
        vectors.extend([DVec3::Y; 100]);
        let faces = NearFaces::new(vectors.iter().copied());
        assert!(!faces.nodes.is_empty());
        for own in &vectors {
            let own = own.normalize_or_zero();
            let near = vectors
                .iter()
                .filter(|v| v.normalize_or_zero().dot(own) > EDGE);
            let expected: DVec3 = near.sum();
            let found = faces.sum(own);
            assert!(
                (found - expected).length() < 1e-9,
                "{own}: {found}, {expected}"
            );
        }
    }
}
