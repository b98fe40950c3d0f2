//! Vertices, or indices, of all meshes on the GPU: in buffers for drawing, and for shaders in a texture as well where
//! drivers read textures faster.

use bytemuck::Pod;

use reflet_gpu::{Gpu, GpuError};

use super::{chunked_array::ChunkedArray, texel_array::TexelArray};

/// An array that is drawn from and read by shaders.
#[derive(Clone, Debug)]
pub struct MeshArray {
    buffers: ChunkedArray,
    /// Copy that shaders read; without, they read the buffers.
    texels: Option<TexelArray>,
}

impl MeshArray {
    /// An array of `count` elements, never of zero size.
    ///
    /// # Errors
    /// A wgpu error.
    fn sized<T: Pod>(
        gpu: &Gpu,
        name: &str,
        count: usize,
        usage: wgpu::BufferUsages,
        in_texels: bool,
    ) -> Result<Self, GpuError> {
        let texels = in_texels.then(|| TexelArray::sized::<T>(gpu, name, count));
        Ok(Self {
            buffers: ChunkedArray::sized::<T>(gpu, name, count, usage)?,
            texels: texels.transpose()?,
        })
    }

    /// Writes elements, starting at index `first`.
    pub fn write<T: Pod>(&self, gpu: &Gpu, first: usize, elements: &[T]) {
        self.buffers.write(gpu, first, elements);
        if let Some(texels) = &self.texels {
            texels.write(gpu, first, elements);
        }
    }

    /// Total size of buffers and texture, bytes.
    pub fn size(&self) -> u64 {
        self.buffers.size() + self.texels.as_ref().map_or(0, TexelArray::size)
    }

    /// The only buffer; `None` where there are several.
    pub fn whole(&self) -> Option<&wgpu::Buffer> {
        self.buffers.whole()
    }

    /// Whether shaders read the array from a texture.
    pub const fn is_texels(&self) -> bool {
        self.texels.is_some()
    }

    /// Number of shader bindings; 1 for a texture.
    pub fn count(&self) -> u32 {
        match self.is_texels() {
            true => 1,
            false => self.buffers.count(),
        }
    }

    /// Shader binding of the chunk with this number; `None` past the last one.
    pub fn binding(&self, chunk: usize) -> Option<wgpu::BindingResource<'_>> {
        match &self.texels {
            Some(texels) => Some(texels.resource()),
            None => self.buffers.binding(chunk),
        }
    }
}

/// Upload of a new array in pieces, so that few elements are in memory at a time.
pub struct Upload<'a, T> {
    gpu: &'a Gpu,
    array: MeshArray,
    /// Number of elements written so far.
    written: usize,
    piece: Vec<T>,
    /// Maximum number of elements of a piece.
    most: usize,
}

impl<'a, T: Pod> Upload<'a, T> {
    /// Starts the upload of an array of `count` elements, of buffers with this usage and, if `in_texels`, a texture.
    ///
    /// # Errors
    /// A wgpu error.
    pub fn new(
        gpu: &'a Gpu,
        name: &str,
        count: usize,
        usage: wgpu::BufferUsages,
        in_texels: bool,
    ) -> Result<Self, GpuError> {
        let most = Gpu::PIECE_BYTES / size_of::<T>();
        Ok(Self {
            gpu,
            array: MeshArray::sized::<T>(gpu, name, count, usage, in_texels)?,
            written: 0,
            piece: Vec::with_capacity(count.min(most)),
            most,
        })
    }

    /// Appends the next elements.
    ///
    /// # Errors
    /// A lost device.
    pub fn extend(&mut self, elements: impl Iterator<Item = T>) -> Result<(), GpuError> {
        let mut elements = elements.fuse();
        loop {
            let room = self.most - self.piece.len();
            self.piece.extend(elements.by_ref().take(room));
            if self.piece.len() < self.most {
                return Ok(());
            }
            self.write();
            self.gpu.finish_writes()?;
        }
    }

    fn write(&mut self) {
        self.array.write(self.gpu, self.written, &self.piece);
        self.written += self.piece.len();
        self.piece.clear();
    }

    /// Writes the last piece and returns the array.
    pub fn finish(mut self) -> MeshArray {
        self.write();
        self.array
    }
}
