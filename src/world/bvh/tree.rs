//! Compressed wide BVH over boxes, built by obvhs.

use std::{borrow::Cow, time::Duration};

use glam::Vec3A;
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    cwbvh::{builder::build_cwbvh, node::CwBvhNode},
};

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
    /// Builds a tree over finite `boxes`, with up to three in a leaf.
    pub fn build(boxes: &[Aabb]) -> Self {
        if boxes.is_empty() {
            return Self {
                nodes: vec![CwBvhNode::default()],
                order: Vec::new(),
                stack_need: 0,
            };
        }
        // Slower presets are within 5 % of this one when traced; the fastest is 18 % behind.
        let params = BvhBuildParams {
            max_prims_per_leaf: 3,
            ..BvhBuildParams::fast_build()
        };
        let tree = build_cwbvh(&distinct(boxes), params, &mut Duration::default());
        Self {
            stack_need: stack_need(&tree.nodes),
            nodes: tree.nodes,
            order: tree.primitive_indices,
        }
    }
}

/// The boxes, with those that share a center grown by small amounts that differ. The builder merges boxes that are each
/// other's nearest neighbor, round by round. Of boxes that are equal, or nested in each other, that is one pair a round,
/// so that a thousand would take a thousand rounds. What equal boxes grow to lies around them like points, and has one
/// size.
fn distinct(boxes: &[Aabb]) -> Cow<'_, [Aabb]> {
    let center = |&i: &usize| {
        ((boxes[i].min + boxes[i].max) * 0.5)
            .to_array()
            .map(f32::to_bits)
    };
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_unstable_by_key(|i| (center(i), *i));
    let mut grown = Cow::Borrowed(boxes);
    for same in order.chunk_by(|a, b| center(a) == center(b)) {
        for (k, &i) in (0u32..).zip(same).skip(1) {
            let Aabb { min, max } = boxes[i];
            let growth = ((max - min).max_element() * 1e-3)
                .max(min.abs().max(max.abs()).max_element() * 1e-5);
            // Weyl sequence of three dimensions, evenly spread and uncorrelated with the order.
            let steps = [0xd1b5_4a33_u32, 0xabc9_8389, 0x8cb9_2ba7];
            let share = steps.map(|step| (k.wrapping_mul(step) >> 8) as f32 / (1u32 << 24) as f32);
            let below = Vec3A::from_array(share) * growth;
            grown.to_mut()[i] = Aabb::new(min - below, max + (Vec3A::splat(growth) - below));
        }
    }
    grown
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

    /// Rounds in which boxes are merged that are each other's nearest neighbor within two places of their order, as
    /// the builder does it, until one is left.
    fn rounds(boxes: &[Aabb]) -> usize {
        let mut left = boxes.to_vec();
        let key = |b: &Aabb| (b.min + b.max).to_array();
        left.sort_by(|a, b| key(a).partial_cmp(&key(b)).expect("finite"));
        let mut count = 0;
        while left.len() > 1 {
            count += 1;
            let cost = |i: usize, k: usize| left[i].union(&left[k]).half_area();
            let nearest = |i: usize| {
                let others = (i.saturating_sub(2)..left.len().min(i + 3)).filter(|&k| k != i);
                others.min_by(|&a, &b| cost(i, a).total_cmp(&cost(i, b)))
            };
            let best: Vec<_> = (0..left.len()).map(nearest).collect();
            let merged = (0..left.len()).filter_map(|i| match best[i] {
                Some(k) if best[k] == Some(i) => (i < k).then(|| left[i].union(&left[k])),
                _ => Some(left[i]),
            });
            left = merged.collect();
        }
        count
    }

    #[test]
    fn boxes_at_one_place_are_merged_in_few_rounds() {
        let unit = Aabb::new(Vec3A::splat(-0.5), Vec3A::splat(0.5));
        let far = Aabb::new(Vec3A::splat(1000.0), Vec3A::splat(1000.1));
        let flat = Aabb::new(Vec3A::new(-1.0, 0.0, -1.0), Vec3A::new(1.0, 0.0, 1.0));
        let point = Aabb::new(Vec3A::ONE, Vec3A::ONE);
        for one in [unit, far, flat, point] {
            let boxes = vec![one; 2000];
            let grown = distinct(&boxes);
            let found = rounds(&grown);
            assert!(found < 100, "{found} rounds for 2,000 copies of {one:?}");
            let holds = |b: &Aabb| b.min.cmple(one.min).all() && b.max.cmpge(one.max).all();
            assert!(grown.iter().all(holds) && grown[0] == one);
            let most = (one.max - one.min).max_element() * 1e-3 + 1e-2;
            let near = |b: &Aabb| (one.min - b.min).max(b.max - one.max).max_element() <= most;
            assert!(grown.iter().all(near));
        }
    }
}
