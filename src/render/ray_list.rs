//! The list of the pixels whose reflection is traced, and the counters of the frame.

use crate::gpu::{Gpu, GpuError, Named};

use super::cause::Cause;

/// Counters of a frame: one for each cause, then rays that ended without an answer, then the number of
/// listed rays.
pub const COUNTERS: usize = 16;
/// Index of the number of rays among the counters; those before it count causes.
pub const RAY_COUNTER: usize = COUNTERS - 1;
/// Index of the number of rays that visited as many nodes as a ray may.
pub const EXHAUSTED_COUNTER: usize = COUNTERS - 2;
/// Rays that one workgroup of the trace pass follows.
pub const RAYS_PER_GROUP: u32 = 64;

const _: () = assert!(Cause::ALL.len() <= EXHAUSTED_COUNTER);

/// The ray list and what counts it.
#[derive(Clone, Debug)]
pub struct RayList {
    /// A pixel (x | y << 16) for each ray.
    pub rays: wgpu::Buffer,
    /// See [`RAY_COUNTER`].
    pub counters: wgpu::Buffer,
    /// Workgroups of the trace pass.
    pub arguments: wgpu::Buffer,
}

impl RayList {
    /// Room for a ray from every pixel, or for none where no ray is traced.
    ///
    /// # Errors
    /// A picture whose list is past the adapter's buffer limit.
    pub fn new(gpu: &Gpu, size: [u32; 2], traced: bool) -> Result<Self, GpuError> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let rays = if traced { pixels } else { 1 };
        let bytes = (4 * rays).next_multiple_of(16);
        gpu.check_buffer_size("the ray list of this picture size", bytes)?;
        let storage = wgpu::BufferUsages::STORAGE;
        let make = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        gpu.scoped("ray list", || Self {
            rays: make("rays", bytes, storage | wgpu::BufferUsages::COPY_SRC),
            counters: make(
                "counters",
                4 * COUNTERS as u64,
                storage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            ),
            arguments: make("arguments", 16, storage | wgpu::BufferUsages::INDIRECT),
        })
    }

    /// Its buffers by their names in the shaders.
    pub fn named(&self) -> [Named<'_>; 3] {
        [
            ("rays", self.rays.as_entire_binding()),
            ("counters", self.counters.as_entire_binding()),
            ("arguments", self.arguments.as_entire_binding()),
        ]
    }
}
