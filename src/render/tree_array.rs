//! Nodes or triangles of the trees on the GPU: in buffers, or in a texture where drivers read those faster.

use bytemuck::{Pod, cast_slice};

use crate::gpu::{Gpu, GpuError};

use super::chunks::ChunkedArray;

/// Texels of a row of the textures that hold trees.
pub const TEXEL_COLUMNS: u32 = 4096;
/// Of four words.
const TEXEL_BYTES: u64 = 16;

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

    /// Whether textures are to hold arrays of these sizes.
    pub fn prefers_texels(gpu: &Gpu, bytes: [usize; 2]) -> bool {
        let rows = |bytes: usize| texel_rows(bytes as u64 / TEXEL_BYTES);
        let most = u64::from(gpu.limits.max_texture_dimension_2d);
        let fits =
            |bytes: usize| rows(bytes) <= most && bytes as u64 <= gpu.largest_storage_buffer();
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
            Self::Texels(array) => Some(wgpu::BindingResource::TextureView(&array.view)),
        }
    }
}

/// An array in the rows of a texture.
#[derive(Clone, Debug)]
pub struct TexelArray {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
}

impl TexelArray {
    fn new<T: Pod>(gpu: &Gpu, name: &str, data: &[T]) -> Result<Self, GpuError> {
        let texels = size_of_val(data) as u64 / TEXEL_BYTES;
        let descriptor = wgpu::TextureDescriptor {
            label: Some(name),
            size: wgpu::Extent3d {
                width: TEXEL_COLUMNS,
                height: texel_rows(texels) as u32,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let texture = gpu.scoped(name, || gpu.device.create_texture(&descriptor))?;
        let array = Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            texture,
        };
        array.write(gpu, 0, data);
        Ok(array)
    }

    /// The rest of the first row, then whole rows, then what is left.
    fn write<T: Pod>(&self, gpu: &Gpu, first: usize, elements: &[T]) {
        let mut bytes: &[u8] = cast_slice(elements);
        let mut at = (first * size_of::<T>()) as u64 / TEXEL_BYTES;
        let columns = u64::from(TEXEL_COLUMNS);
        while !bytes.is_empty() {
            let texels = bytes.len() as u64 / TEXEL_BYTES;
            let (x, y) = (at % columns, at / columns);
            let (width, height) = match x == 0 && texels >= columns {
                true => (columns, texels / columns),
                false => (texels.min(columns - x), 1),
            };
            let (now, later) = bytes.split_at((width * height * TEXEL_BYTES) as usize);
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    origin: wgpu::Origin3d {
                        x: x as u32,
                        y: y as u32,
                        z: 0,
                    },
                    ..self.texture.as_image_copy()
                },
                now,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some((width * TEXEL_BYTES) as u32),
                    rows_per_image: None,
                },
                wgpu::Extent3d {
                    width: width as u32,
                    height: height as u32,
                    depth_or_array_layers: 1,
                },
            );
            at += width * height;
            bytes = later;
        }
    }

    fn size(&self) -> u64 {
        let size = self.texture.size();
        u64::from(size.width) * u64::from(size.height) * TEXEL_BYTES
    }
}

/// Rows for so many texels, at least one.
fn texel_rows(texels: u64) -> u64 {
    texels.div_ceil(u64::from(TEXEL_COLUMNS)).max(1)
}
