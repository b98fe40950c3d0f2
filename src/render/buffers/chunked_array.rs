//! Arrays of the scene's geometry in buffers, bound to shaders as one or several bindings.

use bytemuck::{Pod, cast_slice};

use reflet_gpu::{Gpu, GpuError};

use super::chunks::chunk_bytes;

/// An array that shaders see as one binding, or as several of the same size except the last.
#[derive(Clone, Debug)]
pub struct ChunkedArray {
    /// Buffers, each with as many whole bindings as fit; the last may hold fewer.
    buffers: Vec<wgpu::Buffer>,
    chunk_bytes: u64,
    buffer_bytes: u64,
}

impl ChunkedArray {
    /// An array of `count` elements that are not written yet, never of zero size.
    ///
    /// # Errors
    /// A wgpu error.
    pub fn sized<T: Pod>(
        gpu: &Gpu,
        name: &str,
        count: usize,
        usage: wgpu::BufferUsages,
    ) -> Result<Self, GpuError> {
        let bytes = (count * size_of::<T>()).max(size_of::<T>()).max(16);
        let whole = (bytes as u64).next_multiple_of(16);
        let (chunk_bytes, buffer_bytes) = match whole <= gpu.largest_storage_buffer() {
            true => (whole, whole),
            false => {
                let chunk = chunk_bytes(gpu);
                (chunk, gpu.limits.max_buffer_size / chunk * chunk)
            }
        };
        let mut buffers = Vec::new();
        let mut first = 0;
        while first < whole {
            let size = (whole - first).min(buffer_bytes);
            let make = || gpu.buffer(name, size, usage | wgpu::BufferUsages::COPY_DST);
            buffers.push(gpu.scoped(name, make)?);
            first += size;
        }
        Ok(Self {
            buffers,
            chunk_bytes,
            buffer_bytes,
        })
    }

    /// An initialized array, never of zero size.
    ///
    /// # Errors
    /// A wgpu error, or a lost device.
    pub fn new<T: Pod>(
        gpu: &Gpu,
        name: &str,
        data: &[T],
        usage: wgpu::BufferUsages,
    ) -> Result<Self, GpuError> {
        let array = Self::sized::<T>(gpu, name, data.len(), usage)?;
        let most = Gpu::PIECE_BYTES / size_of::<T>();
        for (piece, first) in data.chunks(most).zip((0..).step_by(most)) {
            array.write(gpu, first, piece);
            gpu.finish_writes()?;
        }
        Ok(array)
    }

    /// Writes elements, starting at index `first`.
    pub fn write<T: Pod>(&self, gpu: &Gpu, first: usize, elements: &[T]) {
        let mut bytes: &[u8] = cast_slice(elements);
        let mut at = (first * size_of::<T>()) as u64;
        while !bytes.is_empty() {
            let (buffer, offset) = (at / self.buffer_bytes, at % self.buffer_bytes);
            let room = self.buffer_bytes - offset;
            let room = usize::try_from(room).unwrap_or(usize::MAX);
            let (now, later) = bytes.split_at(bytes.len().min(room));
            gpu.queue
                .write_buffer(&self.buffers[buffer as usize], offset, now);
            at += now.len() as u64;
            bytes = later;
        }
    }

    /// Total size of all buffers, bytes.
    pub fn size(&self) -> u64 {
        self.buffers.iter().map(wgpu::Buffer::size).sum()
    }

    /// The only buffer; `None` where there are several.
    pub fn whole(&self) -> Option<&wgpu::Buffer> {
        match self.buffers.as_slice() {
            [whole] => Some(whole),
            _ => None,
        }
    }

    /// Number of bindings.
    pub fn count(&self) -> u32 {
        self.size().div_ceil(self.chunk_bytes) as u32
    }

    /// Binding of the chunk with this number; `None` past the last one.
    pub fn binding(&self, chunk: usize) -> Option<wgpu::BindingResource<'_>> {
        let at = chunk as u64 * self.chunk_bytes;
        let buffer = self.buffers.get((at / self.buffer_bytes) as usize)?;
        let offset = at % self.buffer_bytes;
        let size = buffer.size().checked_sub(offset)?.min(self.chunk_bytes);
        Some(wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer,
            offset,
            size: Some(wgpu::BufferSize::new(size)?),
        }))
    }
}
