//! Compressed wide BVH over boxes, improved and widened by obvhs.

use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, reinsertion::ReinsertionOptimizer},
    cwbvh::{bvh2_to_cwbvh::Bvh2Converter, node::CwBvhNode},
};

use super::{STACK_SIZE, cluster::cluster};

/// Boxes of a leaf at most.
const MOST_IN_LEAF: u32 = 3;
/// Share of nodes that are moved to where they cost least. With the reach of the clustering this is the preset
/// `fast_build` of obvhs: slower ones are within 5 % of it when traced; the fastest is 18 % behind.
const REINSERTED_SHARE: f32 = 0.02;
/// Levels of a binary tree, which is widened by recursion.
const MOST_LEVELS: usize = 500;

/// Nodes with indices that start at 0; see [`rebase`].
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// Nodes, the root first and children after their parents; never empty.
    pub nodes: Vec<CwBvhNode>,
    /// Box index at each position of the leaf order.
    pub order: Vec<u32>,
    /// Maximum stack depth of traversal.
    pub stack_need: u32,
}

impl Tree {
    /// Builds a tree over finite `boxes`. One that takes more than half of the traversal's stack is built anew,
    /// balanced.
    pub fn build(boxes: &[Aabb]) -> Self {
        if boxes.is_empty() {
            return Self {
                nodes: vec![CwBvhNode::default()],
                order: Vec::new(),
                stack_need: 0,
            };
        }
        let mut optimized = cluster(boxes, true);
        // The default size of its stack: one on which an overfull branch is forgotten, where a larger one panics.
        ReinsertionOptimizer::default().run(&mut optimized, REINSERTED_SHARE, None);
        Self::shallow(&optimized).unwrap_or_else(|| {
            let balanced = cluster(boxes, false);
            // Nodes of one size, so that as many as possible are children of one.
            let mut even = balanced.clone();
            let size = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
            even.nodes.iter_mut().for_each(|node| node.set_aabb(size));
            Self::widened(&balanced, &even)
        })
    }

    /// The wide tree of a binary tree; `None` if the binary or the wide tree is too deep.
    fn shallow(tree: &Bvh2) -> Option<Self> {
        let wide = (!is_deeper(tree, 0, MOST_LEVELS)).then(|| Self::widened(tree, tree));
        wide.filter(|wide| wide.stack_need <= STACK_SIZE / 2)
    }

    /// The wide tree of a binary tree; the sizes of nodes of `chosen_by` decide which nodes become children of a wide
    /// node.
    fn widened(tree: &Bvh2, chosen_by: &Bvh2) -> Self {
        let mut wide = Bvh2Converter::new(chosen_by, true, false);
        wide.calculate_cost(MOST_IN_LEAF);
        wide.bvh2 = tree;
        wide.convert_to_cwbvh();
        Self {
            stack_need: stack_need(&wide.nodes),
            nodes: wide.nodes,
            order: wide.primitive_indices,
        }
    }
}

/// Whether a part of a tree has more than so many levels.
fn is_deeper(tree: &Bvh2, node: u32, levels: usize) -> bool {
    let found = &tree.nodes[node as usize];
    let children = || [found.first_index, found.first_index + 1];
    let is_deep = |child: u32| levels == 0 || is_deeper(tree, child, levels - 1);
    !found.is_leaf() && children().into_iter().any(is_deep)
}

/// Shifts indices in nodes: children by `node_shift`, primitives by `primitive_shift`.
pub(super) fn rebase(nodes: &mut [CwBvhNode], node_shift: u32, primitive_shift: u32) {
    for node in nodes {
        node.child_base_idx += node_shift;
        node.primitive_base_idx += primitive_shift;
    }
}

/// Maximum stack depth of traversal, which descends into one child of a node and keeps the others in one stack
/// entry.
fn stack_need(nodes: &[CwBvhNode]) -> u32 {
    let mut need = vec![0u32; nodes.len()];
    for (i, node) in nodes.iter().enumerate().rev() {
        let children = node.imask.count_ones();
        let first = node.child_base_idx as usize;
        let below = need[first..][..children as usize].iter().max();
        need[i] = below.copied().unwrap_or(0) + u32::from(children > 1);
    }
    need[0]
}

#[cfg(test)]
mod tests {
    use obvhs::bvh2::node::Bvh2Node;

    use super::*;

    /// Boxes of triangles around one vertex, along a line, nested in all sizes, and equal, also of points at the
    /// origin: the tree is shallow, each box is in one leaf, and inside of all boxes above it.
    #[test]
    fn trees_of_hostile_boxes_are_shallow() {
        let around = |a: Vec3A, b: Vec3A| Aabb::new(a.min(b), a.max(b));
        type Corner = fn(f32) -> Vec3A;
        let kinds: [(&str, Corner, bool); 6] = [
            (
                "fan",
                |i| Vec3A::new(i % 999.0, (i / 999.0).floor(), 0.0),
                true,
            ),
            (
                "nested",
                |i| Vec3A::splat(f32::exp2(i / 400.0 - 50.0)),
                true,
            ),
            ("line", |i| Vec3A::X * i, false),
            ("spiral", |i| Vec3A::new(i.sin(), i.cos(), 0.01) * i, true),
            ("equal", |_| Vec3A::new(1.0, 2.0, 0.0), true),
            ("points", |_| Vec3A::ZERO, false),
        ];
        for (name, corner, from_origin) in kinds {
            let other = |i: f32| {
                if from_origin {
                    Vec3A::ZERO
                } else {
                    corner(i + 1.0)
                }
            };
            let one = |i: i16| around(corner(f32::from(i)), other(f32::from(i)));
            let boxes: Vec<Aabb> = (0..30_000).map(one).collect();
            let tree = Tree::build(&boxes);
            assert!(
                tree.stack_need <= STACK_SIZE / 2,
                "{name}: {}",
                tree.stack_need
            );
            let mut order = tree.order.clone();
            order.sort_unstable();
            assert!(order.into_iter().eq(0..30_000), "{name}");
            for patient in [false, true] {
                let binary = cluster(&boxes, patient);
                assert!(
                    !is_deeper(&binary, 0, if patient { 200 } else { 15 }),
                    "{name}"
                );
            }
        }
    }

    /// A binary tree of a leaf a level is as deep as no recursion may be.
    #[test]
    fn deep_binary_trees_are_not_widened() {
        let boxes: u32 = 400_000;
        let mut tree = Bvh2::zeroed(boxes as usize);
        tree.primitive_indices = (0..boxes).collect();
        let one = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
        for level in 0..boxes as usize {
            let (node, index) = (2 * level, level as u32);
            tree.nodes[node] = match index == boxes - 1 {
                true => Bvh2Node::new(one, 1, index),
                false => Bvh2Node::new(one, 0, 2 * index + 1),
            };
            if let Some(leaf) = tree.nodes.get_mut(node + 1) {
                *leaf = Bvh2Node::new(one, 1, index);
            }
        }
        tree.children_are_ordered_after_parents = true;
        assert!(Tree::shallow(&tree).is_none());
    }
}
