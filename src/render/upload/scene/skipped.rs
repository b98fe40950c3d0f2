//! Instances that reflection rays skip, as the device knows them: flags of their records, and a top level without them.

use reflet_gpu::Gpu;
use reflet_world::{World, bvh::Trees};

use super::GpuScene;

impl GpuScene {
    /// Uploads the top level for reflection rays, where they have their own.
    pub fn write_reflected(&self, gpu: &Gpu, trees: &Trees) {
        if let Some(range) = trees.reflected_range() {
            (self.nodes).write(gpu, range.start, &trees.nodes[range]);
        }
    }

    /// Has reflection rays skip these instances, in ascending order, and no others.
    pub fn set_skipped(&mut self, gpu: &Gpu, world: &World, trees: &Trees, skipped: &[usize]) {
        let mut wanted = vec![false; skipped.last().map_or(0, |last| last + 1)];
        for index in skipped {
            wanted[*index] = true;
        }
        let was = std::mem::replace(&mut self.skipped, wanted);
        let is = |list: &[bool], index: usize| list.get(index).copied().unwrap_or(false);
        let mut changed =
            (0..world.instances.len()).filter(|i| is(&was, *i) != is(&self.skipped, *i));
        let Some(first) = changed.next() else { return };
        let last = changed.next_back().unwrap_or(first);
        self.write_instances(gpu, world, trees, first..last + 1);
        if let Some(structures) = &mut self.structures {
            structures.update(gpu, world, trees, &self.skipped);
        }
    }
}
