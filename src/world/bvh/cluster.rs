//! Binary trees over boxes by parallel locally-ordered clustering (Meister and Bittner, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction", TVCG 2018), as in obvhs but with a bound of rounds: boxes
//! that are nested in each other, as triangles around one vertex are, or equal, would merge one pair a round into a
//! tree as deep as their number.

use std::array;

use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node},
    ploc::morton::morton_encode_u64_unorm,
};
use rayon::prelude::*;

/// Places in the order before and after a cluster where its nearest neighbor is looked for.
const REACH: usize = 6;
/// First rounds, in which only adjacent clusters merge.
const ADJACENT_ROUNDS: usize = 2;
/// Number of clusters up to which a round may merge as few as it likes, and its share of them above.
const FEW: usize = 64;
const LEAST_SHARE: usize = 32;
/// Fewest clusters that are worth a task of a thread.
const TASK: usize = 4096;

/// Merges finite boxes, which there are, to one tree; with `patient` false, all adjacent boxes of the Morton order in
/// each round, so that it is balanced. Its depth grows with the logarithm of the number of boxes.
pub(super) fn cluster(boxes: &[Aabb], patient: bool) -> Bvh2 {
    let each = boxes.par_iter().with_min_len(TASK);
    let total = (each.clone().copied()).reduce(Aabb::empty, |total, one| total.union(&one));
    let scale = 1.0 / total.diagonal().as_dvec3();
    let offset = -total.min.as_dvec3() * scale;
    let code = |one: &Aabb| morton_encode_u64_unorm(one.center().as_dvec3() * scale + offset);
    let indexed = each.enumerate().map(|(i, one)| (code(one), i as u32));
    let mut order: Vec<(u64, u32)> = indexed.collect();
    // By the index too, so that boxes of one code have one order with any number of threads.
    order.par_sort_unstable();
    let leaf = |(_, index): (u64, u32)| Bvh2Node::new(boxes[index as usize], 1, index);
    let ordered = order.into_par_iter().with_min_len(TASK);
    let mut clusters: Vec<Bvh2Node> = ordered.map(leaf).collect();
    let mut tree = Bvh2::zeroed(boxes.len());
    tree.primitive_indices = (0..boxes.len() as u32).collect();
    let mut free = tree.nodes.len();
    let mut round = 0;
    while clusters.len() > 1 {
        let reach = if round < ADJACENT_ROUNDS { 1 } else { REACH };
        let mut partners = match patient {
            true => nearest(&clusters, reach),
            false => Vec::new(),
        };
        let is_pair = |partners: &[u32], i: usize| {
            let partner = partners[i] as usize;
            partner != i && partners[partner] as usize == i
        };
        let merging = (0..partners.len())
            .into_par_iter()
            .with_min_len(TASK)
            .filter(|i| is_pair(&partners, *i))
            .count();
        if merging * LEAST_SHARE < clusters.len() && (merging == 0 || clusters.len() > FEW) {
            let last = clusters.len() as u32 - 1;
            partners = (0..=last).map(|i| (i ^ 1).min(last)).collect();
        }
        let mut next = Vec::with_capacity(clusters.len());
        for (i, cluster) in clusters.iter().enumerate() {
            let partner = partners[i] as usize;
            if !is_pair(&partners, i) {
                next.push(*cluster);
            } else if partner < i {
                free -= 2;
                tree.nodes[free] = *cluster;
                tree.nodes[free + 1] = clusters[partner];
                let both = cluster.aabb().union(clusters[partner].aabb());
                next.push(Bvh2Node::new(both, 0, free as u32));
            }
        }
        clusters = next;
        round += 1;
    }
    tree.nodes[0] = clusters[0];
    tree.children_are_ordered_after_parents = true;
    tree
}

/// Index of each cluster's nearest neighbor within `reach`, by the area of the box around both; the last of equal ones.
fn nearest(clusters: &[Bvh2Node], reach: usize) -> Vec<u32> {
    let area = |i: usize, other: usize| match clusters.get(other) {
        Some(other) => clusters[i].aabb().union(other.aabb()).half_area(),
        None => f32::INFINITY,
    };
    let mut nearest = vec![0; clusters.len()];
    let tasks = nearest.par_chunks_mut(TASK).enumerate();
    tasks.for_each(|(task, nearest)| {
        let (first, end) = (task * TASK, task * TASK + nearest.len());
        let start = first.saturating_sub(reach);
        let ahead = (start..end).map(|i| {
            array::from_fn(|k| match k < reach {
                true => area(i, i + k + 1),
                false => f32::INFINITY,
            })
        });
        let ahead: Vec<[f32; REACH]> = ahead.collect();
        for (i, found) in (first..end).zip(nearest) {
            let before = (1..=reach.min(i)).rev();
            let before = before.map(|k| (ahead[i - k - start][k - 1], i - k));
            let after = 1..=reach.min(clusters.len() - 1 - i);
            let after = after.map(|k| (ahead[i - start][k - 1], i + k));
            let closer = |best: (f32, usize), other: (f32, usize)| match other.0 <= best.0 {
                true => other,
                false => best,
            };
            *found = before.chain(after).fold((f32::INFINITY, i), closer).1 as u32;
        }
    });
    nearest
}
