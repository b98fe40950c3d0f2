//! Arrays of 32-bit words stored in the rows of a texture.

use bytemuck::{Pod, cast_slice};

use reflet_gpu::{Gpu, GpuError};

/// Number of texels per row.
pub const TEXEL_COLUMNS: u32 = 4096;

/// An array whose elements are whole texels: of four words each, or of one where the elements are words.
#[derive(Clone, Debug)]
pub struct TexelArray {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    /// Size of a texel, bytes.
    texel_bytes: usize,
}

impl TexelArray {
    /// Creates an array of these elements, never of zero size, in pieces, so that few of them are in memory at a time;
    /// as wide as its data where that is less than a row.
    ///
    /// # Errors
    /// More rows than a texture can have, named by `name`, or a wgpu error.
    pub fn new<T: Pod>(
        gpu: &Gpu,
        name: &str,
        mut elements: impl ExactSizeIterator<Item = T>,
    ) -> Result<Self, GpuError> {
        let array = Self::sized::<T>(gpu, name, elements.len())?;
        let most = Gpu::PIECE_BYTES / size_of::<T>();
        let mut written = 0;
        while elements.len() > 0 {
            let piece: Vec<T> = elements.by_ref().take(most).collect();
            array.write(gpu, written, &piece);
            written += piece.len();
            gpu.finish_writes()?;
        }
        Ok(array)
    }

    /// Creates an array of `count` elements that are not written yet, never of zero size.
    ///
    /// # Errors
    /// Same errors as [`TexelArray::new`].
    pub fn sized<T: Pod>(gpu: &Gpu, name: &str, count: usize) -> Result<Self, GpuError> {
        let texel_bytes = texel_bytes::<T>();
        let [width, height] = size(count * size_of::<T>() / texel_bytes);
        gpu.check_texture_size(name, width, height)?;
        let format = match texel_bytes == size_of::<u32>() {
            true => wgpu::TextureFormat::R32Uint,
            false => wgpu::TextureFormat::Rgba32Uint,
        };
        let read = match gpu.reads_storage_texels {
            true => wgpu::TextureUsages::STORAGE_BINDING,
            false => wgpu::TextureUsages::TEXTURE_BINDING,
        };
        let usage = wgpu::TextureUsages::COPY_DST | read;
        let texture = gpu.scoped(name, || {
            gpu.texture(name, [width, height, 1], format, usage)
        })?;
        Ok(Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            texture,
            texel_bytes,
        })
    }

    /// Whether shaders had better read an array of this number of elements from a texture: one that a single buffer
    /// could hold, on a driver that reads textures faster.
    pub fn is_preferred<T: Pod>(gpu: &Gpu, count: usize) -> bool {
        let bytes = count * size_of::<T>();
        gpu.reads_texels_faster
            && bytes as u64 <= gpu.largest_storage_buffer()
            && size(bytes / texel_bytes::<T>())[1] <= gpu.limits.max_texture_dimension_2d
    }

    /// Writes elements, starting at index `first`.
    pub fn write<T: Pod>(&self, gpu: &Gpu, first: usize, elements: &[T]) {
        let mut bytes: &[u8] = cast_slice(elements);
        let texels = size_of::<T>() / self.texel_bytes;
        for span in spans(first * texels, elements.len() * texels) {
            let [width, height] = span.size;
            let (now, later) = bytes.split_at((width * height) as usize * self.texel_bytes);
            bytes = later;
            let [x, y] = span.origin;
            let to = wgpu::TexelCopyTextureInfo {
                origin: wgpu::Origin3d { x, y, z: 0 },
                ..self.texture.as_image_copy()
            };
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(width * self.texel_bytes as u32),
                rows_per_image: None,
            };
            let size = wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            };
            gpu.queue.write_texture(to, now, layout, size);
        }
    }

    /// Binding of the texture for shaders.
    pub const fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.view)
    }

    /// Size in bytes.
    pub fn size(&self) -> u64 {
        let size = self.texture.size();
        u64::from(size.width) * u64::from(size.height) * self.texel_bytes as u64
    }
}

/// Shader text with the types of such arrays, of vectors and of words, and functions that return an element by its
/// index: as read-only storage textures, or as sampled ones.
pub fn wgsl(are_storage: bool) -> String {
    let (vectors, words, level) = match are_storage {
        true => (
            "texture_storage_2d<rgba32uint, read>",
            "texture_storage_2d<r32uint, read>",
            "",
        ),
        false => ("texture_2d<u32>", "texture_2d<u32>", ", 0"),
    };
    let load = format!("textureLoad(array, vec2u(i % TEXEL_COLUMNS, i / TEXEL_COLUMNS){level})");
    format!(
        "#import constants
alias VectorTexels = {vectors};
alias WordTexels = {words};
fn vector_at(array: VectorTexels, i: u32) -> vec4u {{ return {load}; }}
fn word_at(array: WordTexels, i: u32) -> u32 {{ return {load}.x; }}
"
    )
}

/// Size of a texel of an array of `T`, bytes.
const fn texel_bytes<T: Pod>() -> usize {
    const { assert!(size_of::<T>() == 4 || size_of::<T>().is_multiple_of(16)) };
    if size_of::<T>() == 4 { 4 } else { 16 }
}

/// Columns and rows for this number of texels, at least one of each.
fn size(texels: usize) -> [u32; 2] {
    let texels = texels.max(1);
    let columns = texels.min(TEXEL_COLUMNS as usize);
    [columns, texels.div_ceil(columns)].map(|n| n as u32)
}

/// A rectangle of texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Span {
    origin: [u32; 2],
    size: [u32; 2],
}

/// Rectangles that cover a range of texels: the rest of the first row, whole rows, and the remainder.
fn spans(first: usize, count: usize) -> Vec<Span> {
    let columns = TEXEL_COLUMNS as usize;
    let (mut at, end) = (first, first + count);
    let mut spans = Vec::new();
    while at < end {
        let (x, y) = (at % columns, at / columns);
        let size = match x == 0 && end - at >= columns {
            true => [columns, (end - at) / columns],
            false => [(end - at).min(columns - x), 1],
        };
        spans.push(Span {
            origin: [x as u32, y as u32],
            size: size.map(|n| n as u32),
        });
        at += size[0] * size[1];
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writes_cover_each_texel_once() {
        let span = |origin, size| Span { origin, size };
        let columns = TEXEL_COLUMNS;
        assert_eq!(spans(7, 0), []);
        assert_eq!(spans(5, 10), [span([5, 0], [10, 1])]);
        assert_eq!(
            spans(4090, 6 + 2 * 4096 + 3),
            [
                span([4090, 0], [6, 1]),
                span([0, 1], [columns, 2]),
                span([0, 3], [3, 1])
            ]
        );
        assert_eq!(spans(4096, 4096), [span([0, 1], [columns, 1])]);
        assert_eq!(size(0), [1, 1]);
        assert_eq!(size(5), [5, 1]);
        assert_eq!(size(4097), [4096, 2]);
    }
}
