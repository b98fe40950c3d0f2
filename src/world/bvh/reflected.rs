//! The top level without skipped instances, which reflection rays traverse.

use std::ops::Range;

use obvhs::{aabb::Aabb, cwbvh::node::CwBvhNode};

use super::{
    NODE_WORDS, STACK_SIZE, TOP_LEVEL, TOP_ROOT, Trees,
    placed::PlacedInstances,
    tree::{self, Tree},
};
use crate::World;

/// Room of the top level for reflection rays in [`Trees::nodes`], and the instances that it leaves out.
#[derive(Clone, Debug)]
pub(super) struct Reflected {
    /// Range of nodes: the root first, then the list of instance ids in leaf order.
    range: Range<usize>,
    /// Index of the first node of that list.
    list: usize,
    /// Skipped instances, ascending.
    skipped: Vec<usize>,
}

impl Reflected {
    /// Room for the top level over so many instances, at the end of the nodes.
    pub fn reserve(nodes: &mut Vec<CwBvhNode>, instances: usize) -> Self {
        let start = nodes.len();
        // Every inner node has at least two children.
        let list = start + instances.max(1);
        let range = start..list + instances.div_ceil(NODE_WORDS);
        nodes.resize(range.end, CwBvhNode::default());
        Self {
            range,
            list,
            skipped: Vec::new(),
        }
    }
}

/// A rebuilt top level for reflection rays, and the instance of each of its primitives.
pub(super) struct ReflectedTop {
    tree: Tree,
    ids: Vec<u32>,
}

impl Trees {
    /// Index of the root from which reflection rays traverse the top level.
    pub fn reflected_root(&self) -> u32 {
        let own = self.reflected.as_ref();
        own.map_or(TOP_ROOT, |reflected| reflected.range.start as u32)
    }

    /// Range in [`Trees::nodes`] of the top level for reflection rays; `None` where they traverse the top level of all
    /// rays.
    pub fn reflected_range(&self) -> Option<Range<usize>> {
        self.reflected.as_ref().map(|r| r.range.clone())
    }

    /// Has reflection rays skip these instances, in ascending order, and no others, in the pose of `world`: rewrites
    /// the nodes of [`Trees::reflected_range`]. Returns whether something has changed.
    pub fn skip(&mut self, world: &World, skipped: &[usize]) -> bool {
        let Some(reflected) = &mut self.reflected else {
            return false;
        };
        if reflected.skipped == skipped {
            return false;
        }
        reflected.skipped = skipped.to_vec();
        let placed = PlacedInstances::new(world, &self.top_instances);
        let top = self.reflected_top(&placed.ids, &placed.boxes);
        self.set_reflected(top);
        true
    }

    /// The top level for reflection rays over the instances of `ids` that are not skipped; over all of `ids` where it
    /// would be deeper than the traversal's stack.
    pub(super) fn reflected_top(&self, ids: &[u32], boxes: &[Aabb]) -> Option<ReflectedTop> {
        let skipped = &self.reflected.as_ref()?.skipped;
        let over = |is_kept: &dyn Fn(u32) -> bool| {
            let kept = ids.iter().zip(boxes).filter(|(id, _)| is_kept(**id));
            let (ids, boxes): (Vec<u32>, Vec<Aabb>) = kept.unzip();
            let tree = Tree::build(&boxes);
            ReflectedTop { tree, ids }
        };
        let top = over(&|id| skipped.binary_search(&(id as usize)).is_err());
        let is_too_deep = top.tree.stack_need + self.mesh_stack_need > STACK_SIZE;
        Some(if is_too_deep { over(&|_| true) } else { top })
    }

    /// Applies a rebuilt top level for reflection rays.
    pub(super) fn set_reflected(&mut self, top: Option<ReflectedTop>) {
        let (Some(reflected), Some(mut top)) = (&self.reflected, top) else {
            return;
        };
        let (start, list) = (reflected.range.start, reflected.list);
        let first_id = TOP_LEVEL | (list * NODE_WORDS) as u32;
        tree::rebase(&mut top.tree.nodes, start as u32, first_id);
        self.nodes[start..start + top.tree.nodes.len()].copy_from_slice(&top.tree.nodes);
        let room = list..reflected.range.end;
        let words: &mut [u32] = bytemuck::cast_slice_mut(&mut self.nodes[room]);
        for (word, primitive) in words.iter_mut().zip(&top.tree.order) {
            *word = top.ids[*primitive as usize];
        }
    }
}
