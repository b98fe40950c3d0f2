//! Download of a finished frame's targets to the CPU.

use std::collections::HashMap;

use bytemuck::Pod;

use reflet_base::math::Bounds;
use reflet_gpu::{
    Gpu, GpuError,
    readback::{self, Pending},
};
use reflet_scene::desc::Method;

use crate::{
    pipeline::targets::Target,
    settings::{coordinates::Coordinates, precision::Precision},
};

/// Copies of targets that the CPU has not received yet.
pub struct Download {
    pub(crate) pending: Pending,
    /// Copied targets, in the order of the copies; the counters come last.
    pub(crate) targets: Vec<Target>,
    /// Values that need no copies.
    pub(crate) values: TargetValues,
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
    /// Bounding box of drawn surfaces, in these coordinates.
    pub drawn: Bounds,
    /// The unit U in these coordinates.
    pub unit: f32,
    pub(crate) bytes: HashMap<Target, Vec<u8>>,
}

impl TargetValues {
    /// Texels of one target; zeros where the frame does not write it or it was not requested.
    pub fn texels<T: Pod>(&self, target: Target) -> Vec<T> {
        if let Some(bytes) = self.bytes.get(&target) {
            return readback::values(bytes);
        }
        let pixels = u64::from(self.size[0]) * u64::from(self.size[1]);
        let bytes = target.pixel_bytes(self.precision.full) * u64::from(target.layers(1)) * pixels;
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
