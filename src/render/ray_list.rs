//! The lists of a frame: reflective pixels, what is traced and what is shaded of them, pixels that let light
//! through, the depth pyramid, and the counters.

use crate::gpu::{Gpu, GpuError, Named};

use super::cause::Cause;

/// Counters of a frame: one for each cause, then those below.
pub const COUNTERS: usize = 20;
/// Index of the number of listed rays among the counters; those before all of these count causes.
pub const RAY_COUNTER: usize = COUNTERS - 1;
/// Index of the number of rays that visited as many nodes as a ray may.
pub const EXHAUSTED_COUNTER: usize = COUNTERS - 2;
/// Index of the number of reflective pixels that are marched.
pub const REFLECTOR_COUNTER: usize = COUNTERS - 3;
/// Index of the number of screen hits.
pub const HIT_COUNTER: usize = COUNTERS - 4;
/// Index of the number of screen hits that were traced too.
pub const AUDITED_COUNTER: usize = COUNTERS - 5;
/// Index of the number of those that lie on a wrong surface.
pub const WRONG_COUNTER: usize = COUNTERS - 6;
/// Index of the number of pixels whose surface lets light through.
pub const TRANSMISSIVE_COUNTER: usize = COUNTERS - 7;
/// Entries of a list that one workgroup of the passes over lists does.
pub const RAYS_PER_GROUP: u32 = 64;
/// Screen hits of a sub-frame that the audit traces too, at most.
pub const AUDIT_RAYS: u32 = 1024;
/// Levels of the depth pyramid over the picture itself: cells of 2 to 64 pixels.
pub const PYRAMID_LEVELS: u32 = 6;

const _: () = assert!(Cause::ALL.len() <= TRANSMISSIVE_COUNTER);

/// Which list a pass runs over; its place among the arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum List {
    /// Reflective pixels.
    Reflectors = 0,
    /// Rays that are traced.
    Rays = 1,
    /// Screen hits that are shaded.
    Hits = 2,
    /// Pixels whose surface lets light through.
    Transmissive = 3,
}

impl List {
    /// Where its workgroups are among the arguments, bytes.
    pub const fn arguments_offset(self) -> u64 {
        self as u64 * ARGUMENT_BYTES
    }
}

const LISTS: u64 = 4;
/// Of what an indirect dispatch reads, padded.
const ARGUMENT_BYTES: u64 = 16;

/// What of the lists a frame uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListedParts {
    /// Reflective pixels, rays, hits and the pyramid.
    pub reflections: bool,
    /// Pixels that let light through: in the place of other lists, or alone.
    pub transmission: bool,
    /// A depth for each pixel of what the camera culls.
    pub culled_surfaces: bool,
}

impl ListedParts {
    /// Two words a pixel, the pyramid of the picture padded to its largest cells, and one word a pixel
    /// for what is culled.
    fn bytes(self, size: [u32; 2]) -> u64 {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        if !self.reflections {
            return (4 * pixels * u64::from(self.transmission)).max(16);
        }
        let padded = size.map(|side| u64::from(side.next_multiple_of(1 << PYRAMID_LEVELS)));
        let area = padded[0] * padded[1];
        let pyramid = (area - (area >> (2 * PYRAMID_LEVELS))) / 3;
        4 * ((2 + u64::from(self.culled_surfaces)) * pixels + pyramid)
    }
}

/// The lists and what counts them.
#[derive(Clone, Debug)]
pub struct RayList {
    /// Pixels (x | y << 16): reflective ones, then rays with hits from the other end, then the
    /// depth pyramid, then the depth of what the camera culls; pixels that let light through in a list that is free.
    /// Layout: `shaders/lib/lists.wgsl`.
    pub lists: wgpu::Buffer,
    /// See [`RAY_COUNTER`].
    pub counters: wgpu::Buffer,
    /// Workgroups of the passes over lists, four numbers each.
    pub arguments: wgpu::Buffer,
}

impl RayList {
    /// Room for every pixel in every list, or for none where nothing reflects or lets light through.
    ///
    /// # Errors
    /// A picture whose lists are past the adapter's buffer limit.
    pub fn new(gpu: &Gpu, size: [u32; 2], parts: ListedParts) -> Result<Self, GpuError> {
        let bytes = parts.bytes(size);
        gpu.check_storage_size("a list of all pixels of this size", bytes)?;
        let storage = wgpu::BufferUsages::STORAGE;
        let make = |label, size, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        gpu.scoped("lists", || Self {
            lists: make("lists", bytes, storage | wgpu::BufferUsages::COPY_SRC),
            counters: make(
                "counters",
                4 * COUNTERS as u64,
                storage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            ),
            arguments: make(
                "arguments",
                LISTS * ARGUMENT_BYTES,
                storage | wgpu::BufferUsages::INDIRECT,
            ),
        })
    }

    /// Its buffers by their names in the shaders.
    pub fn named(&self) -> [Named<'_>; 3] {
        [
            ("lists", self.lists.as_entire_binding()),
            ("counters", self.counters.as_entire_binding()),
            ("arguments", self.arguments.as_entire_binding()),
        ]
    }
}
