//! Nodes or triangles of the trees on the GPU: in buffers, or in a texture where drivers read those faster.

use bytemuck::Pod;

use crate::gpu::{Gpu, GpuError};

use super::{chunked_array::ChunkedArray, texel_array::TexelArray};

/// An array of elements of whole texels.
#[derive(Clone, Debug)]
pub enum TreeArray {
    /// In buffers.
    Buffers(ChunkedArray),
    /// In one texture.
    Texels(TexelArray),
}

impl TreeArray {
    /// An initialized array, never of zero size.
    ///
    /// # Errors
    /// A wgpu error.
    pub fn new<T: Pod>(
        gpu: &Gpu,
        name: &str,
        data: &[T],
        in_texels: bool,
    ) -> Result<Self, GpuError> {
        match in_texels {
            true => TexelArray::new(gpu, name, data).map(Self::Texels),
            false => {
                let usage = wgpu::BufferUsages::STORAGE;
                ChunkedArray::new(gpu, name, data, usage).map(Self::Buffers)
            }
        }
    }

    /// Whether textures are to hold arrays of these sizes: those that one buffer would hold.
    pub fn prefers_texels(gpu: &Gpu, bytes: [usize; 2]) -> bool {
        let fits =
            |bytes| bytes as u64 <= gpu.largest_storage_buffer() && TexelArray::fits(gpu, bytes);
        gpu.reads_texels_faster && bytes.into_iter().all(fits)
    }

    /// Writes elements from an index on.
    pub fn write<T: Pod>(&self, gpu: &Gpu, first: usize, elements: &[T]) {
        match self {
            Self::Buffers(array) => array.write(gpu, first, elements),
            Self::Texels(array) => array.write(gpu, first, elements),
        }
    }

    /// Bytes.
    pub fn size(&self) -> u64 {
        match self {
            Self::Buffers(array) => array.size(),
            Self::Texels(array) => array.size(),
        }
    }

    /// Whether a texture holds it.
    pub const fn is_texels(&self) -> bool {
        matches!(self, Self::Texels(_))
    }

    /// How many shaders see; one of a texture.
    pub fn count(&self) -> u32 {
        match self {
            Self::Buffers(array) => array.count(),
            Self::Texels(_) => 1,
        }
    }

    /// What shaders see of this number, if there is one.
    pub fn binding(&self, chunk: usize) -> Option<wgpu::BindingResource<'_>> {
        match self {
            Self::Buffers(array) => array.binding(chunk),
            Self::Texels(array) => Some(array.resource()),
        }
    }
}
