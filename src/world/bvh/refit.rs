//! Trees of meshes that animations deform: refitted to each pose from the topology at rest, rebuilt where a pose
//! makes the refitted tree too slow to traverse. Earlier frames have no influence.

use std::ops::Range;

use glam::{Vec3, Vec3A};
use obvhs::{aabb::Aabb, cwbvh::node::CwBvhNode};

use super::{
    HALF_STACK, NONE, TraceTriangle,
    gpu_layout::trace_triangle,
    leaves::bounding_box,
    tree::{self, Tree},
};
use crate::Mesh;

/// Ratio above which a refitted tree is rebuilt: its SAH cost to the cost of the tree at rest, each relative to its
/// root's area.
const POOREST: f32 = 1.5;

/// Tree of a mesh at rest, and the ranges of its poses in the buffers of all trees.
#[derive(Clone, Debug)]
pub(super) struct DeformingTree {
    /// Index into [`World::meshes`](crate::World::meshes).
    pub mesh: usize,
    /// Range reserved in [`Trees::nodes`](super::Trees::nodes), with some nodes to spare for a rebuilt tree.
    pub nodes: Range<usize>,
    /// Range in [`Trees::triangles`](super::Trees::triangles).
    pub triangles: Range<usize>,
    rest: Tree,
    rest_cost: f32,
}

/// Tree of a mesh in one pose, with indices into the buffers of all trees.
pub(super) struct PosedTree {
    /// Nodes, at most as many as were reserved.
    pub nodes: Vec<CwBvhNode>,
    /// Triangles in leaf order.
    pub triangles: Vec<TraceTriangle>,
    /// Maximum stack depth of traversal.
    pub stack_need: u32,
}

impl DeformingTree {
    /// Builds the tree of a mesh at rest, whose poses are stored from these buffer indices on.
    pub fn new(mesh: usize, of: &Mesh, first_node: usize, first_triangle: usize) -> Self {
        let boxes = boxes(of, &of.positions);
        let mut rest = Tree::build(&boxes);
        let rest_cost = refit(&mut rest.nodes, &rest.order, &boxes);
        let capacity = rest.nodes.len() + rest.nodes.len() / 2 + 1;
        Self {
            mesh,
            nodes: first_node..first_node + capacity,
            triangles: first_triangle..first_triangle + rest.order.len(),
            rest,
            rest_cost,
        }
    }

    /// The tree of the mesh with its vertices at these positions.
    pub fn pose(&self, mesh: &Mesh, positions: &[Vec3]) -> PosedTree {
        let boxes = boxes(mesh, positions);
        let mut posed = self.rest.clone();
        let cost = refit(&mut posed.nodes, &posed.order, &boxes);
        // False for a NaN cost, which a mesh without extent has.
        if cost > self.rest_cost * POOREST {
            let rebuilt = Tree::build(&boxes);
            let need = rebuilt.stack_need;
            let fits = rebuilt.nodes.len() <= self.nodes.len();
            if fits && need <= HALF_STACK.max(self.rest.stack_need) {
                posed = rebuilt;
            }
        }
        let corners = |t: u32| mesh.triangles[t as usize].map(|i| positions[i as usize]);
        let triangles = posed.order.iter();
        let triangles = triangles.map(|t| trace_triangle(corners(*t), NONE, *t, 0));
        tree::rebase(
            &mut posed.nodes,
            self.nodes.start as u32,
            self.triangles.start as u32,
        );
        PosedTree {
            triangles: triangles.collect(),
            nodes: posed.nodes,
            stack_need: posed.stack_need,
        }
    }
}

/// Bounding boxes of all triangles; a triangle without area may have one in another pose.
fn boxes(mesh: &Mesh, positions: &[Vec3]) -> Vec<Aabb> {
    let triangles = mesh.triangles.iter();
    triangles
        .map(|t| bounding_box(t.map(|i| positions[i as usize])))
        .collect()
}

/// Fits the nodes of a tree to other boxes, and returns its cost by the surface area heuristic, as a
/// multiple of the root's area.
fn refit(nodes: &mut [CwBvhNode], order: &[u32], boxes: &[Aabb]) -> f32 {
    let mut fitted = vec![Aabb::empty(); nodes.len()];
    let mut cost = 0.0;
    // Children come after their parents.
    for at in (0..nodes.len()).rev() {
        let node = &mut nodes[at];
        let mut children: [Option<Aabb>; 8] = [None; 8];
        let mut inner = node.child_base_idx as usize;
        for (slot, child) in children.iter_mut().enumerate() {
            let meta = node.child_meta[slot];
            if node.imask >> slot & 1 == 1 {
                *child = Some(fitted[inner]);
                cost += fitted[inner].half_area();
                inner += 1;
            } else if meta != 0 {
                // The number of primitives is unary in the upper bits.
                let first = node.primitive_base_idx as usize + usize::from(meta & 31);
                let count = (meta >> 5).count_ones();
                let leaf = &order[first..first + count as usize];
                let around = leaf.iter().map(|p| boxes[*p as usize]);
                let around = around.fold(Aabb::empty(), |a, b| a.union(&b));
                *child = Some(around);
                cost += around.half_area() * count as f32;
            }
        }
        let present = children.iter().flatten();
        fitted[at] = present.fold(Aabb::empty(), |a, b| a.union(b));
        quantize(node, &fitted[at], &children);
    }
    cost / fitted[0].half_area()
}

/// Writes the boxes of the children in steps of 1 / 255 of the node's, rounded up to a power of two
/// (Ylitie, Karras, Laine 2017, §3.1), as the builder does.
fn quantize(node: &mut CwBvhNode, around: &Aabb, children: &[Option<Aabb>; 8]) {
    if children.iter().all(Option::is_none) {
        return;
    }
    let size = (around.max - around.min).max(Vec3A::splat(1e-20));
    let step = (size / 255.0).log2().ceil().exp2();
    node.p = around.min.into();
    node.e = step.to_array().map(|step| (step.to_bits() >> 23) as u8);
    for (slot, child) in children.iter().enumerate() {
        let Some(child) = child else { continue };
        let most = Vec3A::splat(255.0);
        let min = ((child.min - around.min) / step).floor();
        let max = ((child.max - around.min) / step).ceil();
        let [min, max] = [min, max].map(|v| v.clamp(Vec3A::ZERO, most).to_array());
        [
            node.child_min_x[slot],
            node.child_min_y[slot],
            node.child_min_z[slot],
        ] = min.map(|v| v as u8);
        [
            node.child_max_x[slot],
            node.child_max_y[slot],
            node.child_max_z[slot],
        ] = max.map(|v| v as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{bvh::cluster::cluster, shape};
    use reflet_scene::desc::ShapeDesc;

    fn sphere() -> Mesh {
        shape::make(
            &ShapeDesc::Sphere {
                radius: 1.0,
                segments: Some(32),
            },
            &shape::Supplies::default(),
        )
        .expect("a sphere")
        .mesh
    }

    /// A refit to the boxes that a tree was built over changes nothing, nor one to boxes of a tree that was widened in
    /// parts of at most 1 to 500 boxes; each has fewer nodes than boxes.
    #[test]
    fn the_rest_pose_is_the_tree_that_was_built() {
        let mesh = sphere();
        let boxes = boxes(&mesh, &mesh.positions);
        let whole = Tree::build(&boxes);
        let binary = cluster(&boxes, true);
        let in_parts = |most| Tree::shallow(&binary, most, HALF_STACK).expect("shallow");
        let parts = [1, 7, 20, 100, 500].map(in_parts);
        for built in parts.into_iter().chain([whole]) {
            let mut refitted = built.nodes.clone();
            refit(&mut refitted, &built.order, &boxes);
            assert_eq!(refitted, built.nodes);
            assert!((51..boxes.len()).contains(&built.nodes.len()));
        }
    }

    /// Every triangle lies in the quantized boxes of all nodes above it.
    #[test]
    fn boxes_hold_what_is_below_them() {
        let mesh = sphere();
        let tree = DeformingTree::new(0, &mesh, 0, 0);
        let twisted =
            |p: &Vec3| glam::Quat::from_rotation_y(p.y * 2.0) * (*p * 3.0) + Vec3::X * 7.0;
        let positions: Vec<Vec3> = mesh.positions.iter().map(twisted).collect();
        let posed = tree.pose(&mesh, &positions);
        assert_eq!(posed.nodes.len(), tree.rest.nodes.len(), "refitted");
        let mut stack = vec![(0usize, Vec::<Aabb>::new())];
        let mut seen = 0;
        while let Some((at, above)) = stack.pop() {
            let node = &posed.nodes[at];
            let mut inner = node.child_base_idx as usize;
            for slot in 0..8 {
                let mut around = above.clone();
                around.push(node.child_aabb(slot));
                let meta = node.child_meta[slot];
                if node.imask >> slot & 1 == 1 {
                    stack.push((inner, around));
                    inner += 1;
                } else if meta != 0 {
                    let first = node.primitive_base_idx as usize + usize::from(meta & 31);
                    for t in &posed.triangles[first..first + (meta >> 5).count_ones() as usize] {
                        let base = Vec3::from(t.base);
                        let corners =
                            [base, base + Vec3::from(t.edge1), base + Vec3::from(t.edge2)];
                        let holds = |b: &Aabb| {
                            let slack = Vec3A::splat(1e-5);
                            corners.iter().all(|c| {
                                let c = Vec3A::from(*c);
                                c.cmpge(b.min - slack).all() && c.cmple(b.max + slack).all()
                            })
                        };
                        assert!(around.iter().all(holds), "triangle {}", t.triangle);
                        seen += 1;
                    }
                }
            }
        }
        assert_eq!(seen, mesh.triangles.len());
    }

    /// A pose that tears neighbors apart is rebuilt, whatever pose came before.
    #[test]
    fn torn_poses_are_rebuilt() {
        let sphere = sphere();
        let count = sphere.triangles.len();
        let corners = |t: usize| sphere.triangles[t].map(|i| sphere.positions[i as usize]);
        let mesh = Mesh {
            positions: (0..count).flat_map(corners).collect(),
            triangles: (0..count as u32)
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .collect(),
            ..Mesh::default()
        };
        // Every triangle moves to the place of another one.
        let torn: Vec<Vec3> = (0..count).flat_map(|t| corners(t * 31 % count)).collect();
        assert_ne!(count % 31, 0);
        let tree = DeformingTree::new(0, &mesh, 0, 0);
        let boxes = boxes(&mesh, &torn);
        let mut refitted = tree.rest.clone();
        let poor = refit(&mut refitted.nodes, &refitted.order, &boxes);
        let mut rebuilt = Tree::build(&boxes);
        let good = refit(&mut rebuilt.nodes, &rebuilt.order, &boxes);
        assert!(good * POOREST < poor, "{good} {poor}");
        let posed = tree.pose(&mesh, &torn);
        assert!(posed.nodes == rebuilt.nodes, "it is not rebuilt");
    }
}
