//! The targets of a finished frame on their way to the CPU.

use std::collections::HashMap;

use bytemuck::Pod;

use crate::{
    gpu::{
        Gpu, GpuError,
        readback::{self, Downloads, Pending},
    },
    scene::desc::Method,
};

use super::{precision::Precision, renderer::Renderer, targets::Target};

/// Copies of targets that the CPU has not got yet.
pub struct Download {
    pending: Pending,
    /// Which targets, in the order of the copies; the counters come last.
    targets: Vec<Target>,
    values: TargetValues,
}

/// What the targets of one frame held.
pub struct TargetValues {
    /// Pixels.
    pub size: [u32; 2],
    /// How reflections were found.
    pub method: Method,
    /// Whether the frame had any.
    pub reflections: bool,
    /// Of the frame, where they were asked for.
    pub counters: Option<Vec<u32>>,
    /// What keeps its light.
    pub precision: Precision,
    bytes: HashMap<Target, Vec<u8>>,
}

impl TargetValues {
    /// Of one target; zeros where the frame does not write it or nobody asked for it.
    pub fn texels<T: Pod>(&self, target: Target) -> Vec<T> {
        if let Some(bytes) = self.bytes.get(&target) {
            return readback::values(bytes);
        }
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let bytes = target.pixel_bytes(self.precision.full) * pixels;
        vec![T::zeroed(); bytes as usize / size_of::<T>()]
    }
}

impl Download {
    /// Waits for the copies, but not for frames that were submitted after them.
    ///
    /// # Errors
    /// A lost or silent device.
    pub fn take(mut self, gpu: &Gpu) -> Result<TargetValues, GpuError> {
        let mut all = self.pending.take(gpu)?;
        if all.len() > self.targets.len() {
            self.values.counters = all.pop().map(|bytes| readback::values(&bytes));
        }
        self.values.bytes = self.targets.into_iter().zip(all).collect();
        Ok(self.values)
    }
}

impl Renderer {
    /// Starts copying targets as the frame submitted last will leave them, and with them the
    /// counters of its reflections.
    ///
    /// # Errors
    /// Exhausted memory, or what wgpu says about the copies.
    pub(super) fn download(
        &self,
        gpu: &Gpu,
        wanted: &[Target],
        count: bool,
    ) -> Result<Download, GpuError> {
        let mut downloads = Downloads::new(gpu);
        let mut targets = Vec::new();
        for target in wanted {
            let texture = self.bindings.targets.texture(*target);
            if let Some(texture) = texture.filter(|_| !targets.contains(target)) {
                downloads.texture(gpu, texture)?;
                targets.push(*target);
            }
        }
        if count && self.plan.reflections {
            downloads.buffer(gpu, &self.bindings.ray_list.counters)?;
        }
        Ok(Download {
            pending: downloads.start(gpu)?,
            targets,
            values: TargetValues {
                size: self.bindings.targets.size,
                method: self.method(),
                reflections: self.plan.reflections,
                counters: None,
                precision: self.plan.precision,
                bytes: HashMap::new(),
            },
        })
    }

    /// The values of a target; zeros where this frame does not write it.
    ///
    /// # Errors
    /// What reading back says.
    pub fn read<T: Pod>(&self, gpu: &Gpu, target: Target) -> Result<Vec<T>, GpuError> {
        Ok(self
            .download(gpu, &[target], false)?
            .take(gpu)?
            .texels(target))
    }
}
