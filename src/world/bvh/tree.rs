//! Compressed wide BVH over boxes, improved and widened by obvhs.

use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
    cwbvh::{bvh2_to_cwbvh::Bvh2Converter, node::CwBvhNode},
};
use rayon::prelude::*;

use super::{HALF_STACK, cluster::cluster};

/// Boxes of a leaf at most.
const MOST_IN_LEAF: u32 = 3;
/// Boxes of a part of a binary tree that is widened at once: the work takes 240 bytes for each, and parts are worked on
/// side by side.
const MOST_IN_PART: u32 = 1 << 17;
/// A part has at least this share of the boxes that it may have.
const LEAST_OF_PART: u32 = 8;
/// Share of nodes that are moved to where they cost least. With the reach of the clustering this is the preset
/// `fast_build` of obvhs: slower ones are within 5 % of it when traced; the fastest is 18 % behind.
const REINSERTED_SHARE: f32 = 0.02;
/// Bits of `child_meta`: the place of the first primitive of a leaf, their number in unary, and the mark of inner nodes.
const FIRST_PRIMITIVE: u8 = 0b1_1111;
const PRIMITIVES: [u8; MOST_IN_LEAF as usize + 1] = [0, 0b10_0000, 0b110_0000, 0b1110_0000];
const INNER: u8 = 0b11_1000;
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
    /// Builds a tree whose traversal needs no more than half of the stack.
    pub fn build(boxes: &[Aabb]) -> Self {
        Self::within(boxes, HALF_STACK)
    }

    /// Builds a tree over finite `boxes` whose traversal needs no more than `stack` entries. If the tree of the surface
    /// area heuristic needs more, a balanced tree replaces it, of which rays visit some four times as many nodes.
    pub fn within(boxes: &[Aabb], stack: u32) -> Self {
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
        Self::shallow(&optimized, MOST_IN_PART, stack).unwrap_or_else(|| {
            let balanced = cluster(boxes, false);
            // Nodes of one size, so that as many as possible are children of one.
            let mut even = balanced.clone();
            let size = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
            even.nodes.iter_mut().for_each(|node| node.set_aabb(size));
            Self::widened(&balanced, &even, MOST_IN_LEAF)
        })
    }

    /// The wide tree of a binary tree, which is widened in parts if it has more than `most_in_part` boxes; `None` if the
    /// binary tree is too deep, or the wide one for a `stack` of so many entries.
    pub fn shallow(tree: &Bvh2, most_in_part: u32, stack: u32) -> Option<Self> {
        let mut counts = vec![0; tree.nodes.len()];
        count_boxes(tree, 0, MOST_LEVELS, &mut counts)?;
        let is_shallow = |wide: &Self| wide.stack_need <= stack;
        let in_parts = (counts[0] > most_in_part).then(|| {
            // Smaller parts would be nodes of their own where they are better spread among other children.
            let sizes = most_in_part / LEAST_OF_PART..=most_in_part;
            let is_part = |count| count <= MOST_IN_LEAF || sizes.contains(&count);
            let top = copy_down(tree, 0, |node| is_part(counts[node as usize]));
            let top = Self::widened(&top, &top, 1);
            let parts = top.order.par_iter().map(|root| Self::part(tree, *root));
            let parts = parts.collect();
            top.with_parts(parts)
        });
        let in_parts = in_parts.filter(is_shallow);
        let whole = || Some(Self::widened(tree, tree, MOST_IN_LEAF)).filter(is_shallow);
        in_parts.or_else(whole)
    }

    /// The wide tree of the boxes below a node of a binary tree.
    fn part(tree: &Bvh2, root: u32) -> Self {
        let part = copy_down(tree, root, |node| tree.nodes[node as usize].is_leaf());
        let mut wide = Self::widened(&part, &part, MOST_IN_LEAF);
        for place in &mut wide.order {
            let leaf = tree.nodes[*place as usize].first_index;
            *place = tree.primitive_indices[leaf as usize];
        }
        wide
    }

    /// The tree with parts, which are trees, in place of its leaves.
    fn with_parts(self, parts: Vec<Self>) -> Self {
        let mut nodes = vec![CwBvhNode::default()];
        let mut order = Vec::with_capacity(parts.iter().map(|part| part.order.len()).sum());
        // Place of each node of this tree, and of the root of each part; parts of a leaf's size are leaves.
        let mut places = vec![0; self.nodes.len()];
        let mut roots = vec![None; parts.len()];
        for (i, mut node) in self.nodes.into_iter().enumerate() {
            let (mut child, first_leaf) = (node.child_base_idx as usize, node.primitive_base_idx);
            let (inner, metas) = (node.imask, node.child_meta);
            node.child_base_idx = nodes.len() as u32;
            node.primitive_base_idx = order.len() as u32;
            let mut primitives = 0;
            for (slot, meta) in metas.into_iter().enumerate().filter(|(_, meta)| *meta != 0) {
                let leaf = || (first_leaf + u32::from(meta & FIRST_PRIMITIVE)) as usize;
                if inner >> slot & 1 == 1 {
                    places[child] = nodes.len();
                    child += 1;
                } else if let Some(count) = PRIMITIVES.get(parts[leaf()].order.len()) {
                    node.child_meta[slot] = count | primitives;
                    order.extend(&parts[leaf()].order);
                    primitives += parts[leaf()].order.len() as u8;
                    continue;
                } else {
                    roots[leaf()] = Some(nodes.len());
                    node.imask |= 1 << slot;
                    node.child_meta[slot] = INNER | slot as u8;
                }
                nodes.push(CwBvhNode::default());
            }
            nodes[places[i]] = node;
        }
        nodes.reserve(parts.iter().map(|part| part.nodes.len() - 1).sum());
        for (mut part, root) in parts.into_iter().zip(roots) {
            let Some(root) = root else { continue };
            rebase(&mut part.nodes, nodes.len() as u32 - 1, order.len() as u32);
            nodes[root] = part.nodes[0];
            nodes.extend_from_slice(&part.nodes[1..]);
            order.append(&mut part.order);
        }
        Self {
            stack_need: stack_need(&nodes),
            nodes,
            order,
        }
    }

    /// The wide tree of a binary tree; the sizes of nodes of `chosen_by` decide which nodes become children of a wide
    /// node.
    fn widened(tree: &Bvh2, chosen_by: &Bvh2, most_in_leaf: u32) -> Self {
        let mut wide = Bvh2Converter::new(chosen_by, true, false);
        wide.calculate_cost(most_in_leaf);
        wide.bvh2 = tree;
        wide.convert_to_cwbvh();
        wide.nodes.shrink_to_fit();
        Self {
            stack_need: stack_need(&wide.nodes),
            nodes: wide.nodes,
            order: wide.primitive_indices,
        }
    }
}

/// Number of boxes below a node of a binary tree, and below each of its descendants in `counts`; `None` for more than
/// so many levels.
fn count_boxes(tree: &Bvh2, node: u32, levels: usize, counts: &mut [u32]) -> Option<u32> {
    let found = &tree.nodes[node as usize];
    let count = match (found.is_leaf(), found.first_index) {
        (true, _) => 1,
        (false, first) => {
            let below = levels.checked_sub(1)?;
            let in_first = count_boxes(tree, first, below, counts)?;
            in_first + count_boxes(tree, first + 1, below, counts)?
        }
    };
    counts[node as usize] = count;
    Some(count)
}

/// Copy of a binary tree from `root` down to nodes for which `is_leaf` is true, whose indices are its primitives.
fn copy_down(tree: &Bvh2, root: u32, is_leaf: impl Fn(u32) -> bool) -> Bvh2 {
    let mut copy = Bvh2::default();
    let add = |copy: &mut Bvh2, source: u32| {
        let mut node = tree.nodes[source as usize];
        if is_leaf(source) {
            node = Bvh2Node::new(*node.aabb(), 1, copy.primitive_indices.len() as u32);
            copy.primitive_indices.push(source);
        }
        copy.nodes.push(node);
    };
    add(&mut copy, root);
    let mut next = 0;
    while let Some(node) = copy.nodes.get(next).copied() {
        if !node.is_leaf() {
            copy.nodes[next].first_index = copy.nodes.len() as u32;
            add(&mut copy, node.first_index);
            add(&mut copy, node.first_index + 1);
        }
        next += 1;
    }
    copy
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
            let holds_all = |tree: Tree| {
                let mut order = tree.order;
                order.sort_unstable();
                tree.stack_need <= HALF_STACK && order.into_iter().eq(0..30_000)
            };
            assert!(holds_all(Tree::build(&boxes)), "{name}");
            for patient in [false, true] {
                let binary = cluster(&boxes, patient);
                let mut counts = vec![0; binary.nodes.len()];
                let levels = if patient { 200 } else { 15 };
                let count = count_boxes(&binary, 0, levels, &mut counts);
                assert_eq!(count, Some(30_000), "{name}");
                let within = |stack| Tree::shallow(&binary, 1000, stack);
                assert!(within(HALF_STACK).is_none_or(holds_all), "{name}");
                let need = within(HALF_STACK).map_or(1, |tree| tree.stack_need);
                let smaller = within(need - 1);
                assert!(smaller.is_none_or(|tree| tree.stack_need < need), "{name}");
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
        assert!(Tree::shallow(&tree, 1, HALF_STACK).is_none());
    }
}
