//! Download of a finished frame's targets to the CPU.

use std::collections::HashMap;

use bytemuck::Pod;

use reflet_base::math::Bounds;
use reflet_gpu::{
    Gpu, GpuError,
    readback::{self, Downloads, Pending},
};
use reflet_scene::desc::Method;

use super::{precision::Precision, relative::Coordinates, renderer::Renderer, targets::Target};

/// Copies of targets that the CPU has not received yet.
pub struct Download {
    pending: Pending,
    /// Copied targets, in the order of the copies; the counters come last.
    targets: Vec<Target>,
    values: TargetValues,
}

/// Texels of the targets of one frame.
pub struct TargetValues {
    /// Size of the picture, pixels.
    pub size: [u32; 2],
    /// Method that found the reflections.
    pub method: Method,
    /// Whether the frame has reflections.
    pub reflections: bool,
    /// Counters of the frame, where they were requested.
    pub counters: Option<Vec<u32>>,
    /// Precision of the stored light.
    pub precision: Precision,
    /// Coordinates of the renderer.
    pub coordinates: Coordinates,
    /// Bounding box of what was drawn, in these coordinates.
    pub drawn: Bounds,
    /// The unit U in these coordinates.
    pub unit: f32,
    bytes: HashMap<Target, Vec<u8>>,
}

impl TargetValues {
    /// Texels of one target; zeros where the frame does not write it or it was not requested.
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
    /// A lost or unresponsive device.
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
    /// Starts copying targets, and if `count` the counters of reflections, as the last submitted frame leaves them.
    ///
    /// # Errors
    /// Exhausted memory, or a wgpu error of the copies.
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
        if count && self.plan.features.reflections {
            downloads.buffer(gpu, &self.bindings.ray_list.counters)?;
        }
        Ok(Download {
            pending: downloads.start(gpu)?,
            targets,
            values: TargetValues {
                size: self.bindings.targets.size,
                method: self.method(),
                reflections: self.plan.features.reflections,
                counters: None,
                precision: self.plan.precision,
                coordinates: self.coordinates,
                drawn: self.drawn_bounds(),
                unit: self.unit_m,
                bytes: HashMap::new(),
            },
        })
    }

    /// Texels of a target; zeros where this frame does not write it.
    ///
    /// # Errors
    /// A readback error.
    pub fn read<T: Pod>(&self, gpu: &Gpu, target: Target) -> Result<Vec<T>, GpuError> {
        Ok(self
            .download(gpu, &[target], false)?
            .take(gpu)?
            .texels(target))
    }
}
