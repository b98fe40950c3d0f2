//! Nodes or triangles of the BVHs on the GPU: in buffers, or in a texture where drivers read textures faster.

use bytemuck::Pod;

use reflet_gpu::{Gpu, GpuError};

use super::{chunked_array::ChunkedArray, texel_array::TexelArray};

/// An array whose elements are whole texels.
#[derive(Clone, Debug)]
pub enum TreeArray {
    /// Array in buffers.
    Buffers(ChunkedArray),
    /// Array in one texture.
    Texels(TexelArray),
}

impl TreeArray {
    /// Creates an initialized array, never of zero size.
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
            true => TexelArray::new(gpu, name, data.iter().copied()).map(Self::Texels),
            false => {
                let usage = wgpu::BufferUsages::STORAGE;
                ChunkedArray::new(gpu, name, data, usage).map(Self::Buffers)
            }
        }
    }

    /// Writes elements, starting at index `first`.
    pub fn write<T: Pod>(&self, gpu: &Gpu, first: usize, elements: &[T]) {
        match self {
            Self::Buffers(array) => array.write(gpu, first, elements),
            Self::Texels(array) => array.write(gpu, first, elements),
        }
    }

    /// Size in bytes.
    pub fn size(&self) -> u64 {
        match self {
            Self::Buffers(array) => array.size(),
            Self::Texels(array) => array.size(),
        }
    }

    /// Whether the array is stored in a texture.
    pub const fn is_texels(&self) -> bool {
        matches!(self, Self::Texels(_))
    }

    /// Number of shader bindings; 1 for a texture.
    pub fn count(&self) -> u32 {
        match self {
            Self::Buffers(array) => array.count(),
            Self::Texels(_) => 1,
        }
    }

    /// Binding of the chunk with this number; `None` past the last one.
    pub fn binding(&self, chunk: usize) -> Option<wgpu::BindingResource<'_>> {
        match self {
            Self::Buffers(array) => array.binding(chunk),
            Self::Texels(array) => Some(array.resource()),
        }
    }
}
