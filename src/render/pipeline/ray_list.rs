//! The lists of a frame: reflective pixels, traced rays, screen hits and transmissive pixels, with the depth pyramid
//! and the counters.

use reflet_gpu::{Gpu, GpuError, Named};

use super::cause::Cause;
use crate::settings::pixel_share::MOMENTS;

/// Number of counters of a frame: one for each cause at the start, and the counters below at the end.
pub const COUNTERS: usize = 28;
/// Index of the counter of listed rays.
pub const RAY_COUNTER: usize = COUNTERS - 1;
/// Index of the counter of rays that ran out of nodes to visit.
pub const EXHAUSTED_COUNTER: usize = COUNTERS - 2;
/// Index of the counter of reflective pixels that are marched.
pub const REFLECTOR_COUNTER: usize = COUNTERS - 3;
/// Index of the counter of screen hits, and of hits that neighbors share.
pub const HIT_COUNTER: usize = COUNTERS - 4;
/// Index of the counter of screen hits that the audit checked.
pub const AUDITED_COUNTER: usize = COUNTERS - 5;
/// Index of the counter of audited screen hits that lie on a wrong surface.
pub const WRONG_COUNTER: usize = COUNTERS - 6;
/// Index of the counter of transmissive pixels.
pub const TRANSMISSIVE_COUNTER: usize = COUNTERS - 7;
/// Index of the counter of marches that went behind the first depth layer, where there is a second.
pub const BEHIND_COUNTER: usize = COUNTERS - 8;
/// Index of the counter of followers: rays that wait for the rays around them.
pub const FOLLOWER_COUNTER: usize = COUNTERS - 9;
/// Index of the counter of followers that are traced after all.
pub const REST_COUNTER: usize = COUNTERS - 10;
/// Index of the counter of leaders: rays that are traced first.
pub const LEADER_COUNTER: usize = COUNTERS - 11;
/// Number of list entries per workgroup of the passes over lists.
pub const RAYS_PER_GROUP: u32 = 64;
/// Maximum number of screen hits of a sub-frame that the audit checks.
pub const AUDIT_RAYS: u32 = 1024;
/// Number of levels of the depth pyramid above the picture itself: cells of 2 to 64 pixels.
pub const PYRAMID_LEVELS: u32 = 6;

const _: () = assert!(Cause::ALL.len() <= LEADER_COUNTER);

/// List that a pass runs over; the value is its index among the dispatch arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum List {
    /// Reflective pixels.
    Reflectors = 0,
    /// Rays that are traced, and hits of the march or of neighbors' rays that are shaded, in workgroups of their own.
    Rays = 1,
    /// Transmissive pixels.
    Transmissive = 2,
}

impl List {
    /// All lists, in the order of their arguments.
    pub const ALL: [Self; LISTS] = [Self::Reflectors, Self::Rays, Self::Transmissive];

    /// Offset of the list's workgroup count in the dispatch arguments, bytes.
    pub const fn arguments_offset(self) -> u64 {
        self as u64 * ARGUMENT_BYTES
    }
}

/// Number of lists.
pub const LISTS: usize = 3;
/// Size of the arguments of an indirect dispatch, padded, bytes.
const ARGUMENT_BYTES: u64 = 16;

/// Parts of the list buffer that a frame uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListedParts {
    /// Whether there are reflective pixels, rays, hits and the pyramid.
    pub reflections: bool,
    /// Whether there is a list of rays that wait for others, with the rays that are traced first from its other end.
    pub undersampled: bool,
    /// Whether there are transmissive pixels: in a list that is free at that time, or alone.
    pub transmission: bool,
    /// Whether pixels of one sub-frame may show different moments.
    pub moments: bool,
}

impl ListedParts {
    /// Size of the buffer: two words per pixel, three where rays wait for others, and the pyramid of the picture padded
    /// to whole cells of the last level.
    fn bytes(self, size: [u32; 2]) -> u64 {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        if !self.reflections {
            return (4 * pixels * u64::from(self.transmission)).max(16);
        }
        let padded = size.map(|side| u64::from(side.next_multiple_of(1 << PYRAMID_LEVELS)));
        let area = padded[0] * padded[1];
        let pyramid = (4 * area - (area >> (2 * PYRAMID_LEVELS))) / 3;
        4 * ((2 + u64::from(self.undersampled)) * pixels + pyramid)
    }
}

/// The list buffer, with its counters and dispatch arguments.
#[derive(Clone, Debug)]
pub struct RayList {
    /// Pixels (x y << 16): reflective ones, then rays with hits from the other end, then rays that wait for others with
    /// rays that are traced first from the other end, where there are any, then the depth pyramid;
    /// transmissive pixels use a list that is free. Layout: `shaders/lib/lists.wgsl`.
    pub lists: wgpu::Buffer,
    /// Counters of causes, rays and hits; see [`RAY_COUNTER`].
    pub counters: wgpu::Buffer,
    /// Counters of all moments that pixels of one sub-frame show, where they show several.
    pub kept_counters: Option<wgpu::Buffer>,
    /// Workgroup counts of the passes over lists, four numbers each.
    pub arguments: wgpu::Buffer,
}

impl RayList {
    /// Creates lists with room for every pixel, or none where nothing reflects or transmits light.
    ///
    /// # Errors
    /// A picture whose lists are past the adapter's buffer limit.
    pub fn new(gpu: &Gpu, size: [u32; 2], parts: ListedParts) -> Result<Self, GpuError> {
        let bytes = parts.bytes(size);
        gpu.check_storage_size("the pixel lists of a picture of this size", bytes)?;
        let storage = wgpu::BufferUsages::STORAGE;
        let make = |label, size, usage| gpu.buffer(label, size, usage);
        gpu.scoped("lists", || Self {
            lists: make("lists", bytes, storage | wgpu::BufferUsages::COPY_SRC),
            counters: make(
                "counters",
                4 * COUNTERS as u64,
                storage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            ),
            kept_counters: parts.moments.then(|| {
                make(
                    "kept counters",
                    4 * COUNTERS as u64 * u64::from(MOMENTS),
                    wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                )
            }),
            arguments: make(
                "arguments",
                LISTS as u64 * ARGUMENT_BYTES,
                storage | wgpu::BufferUsages::INDIRECT,
            ),
        })
    }

    /// Counters of the last sub-frame: one block for each of its moments.
    pub fn counted(&self) -> &wgpu::Buffer {
        self.kept_counters.as_ref().unwrap_or(&self.counters)
    }

    /// The buffers by their names in the shaders.
    pub fn named(&self) -> [Named<'_>; 3] {
        [
            ("lists", self.lists.as_entire_binding()),
            ("counters", self.counters.as_entire_binding()),
            ("arguments", self.arguments.as_entire_binding()),
        ]
    }
}
