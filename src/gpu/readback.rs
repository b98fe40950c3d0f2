//! Readback of textures and buffers, tightly packed.

use std::{
    sync::mpsc::{Receiver, channel},
    time::Duration,
};

use bytemuck::Pod;

use super::{
    context::Gpu,
    error::GpuError,
    wait::{receive, wake},
};

/// Maximum staging buffer size, bytes: a 16384 × 16384 float picture is read in bands of rows.
const MAX_BAND_BYTES: u64 = 64 << 20;

/// Timeout of the map callback after the GPU has finished.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(10);

/// Reads mip 0, layer 0 of a 2D texture, rows from the top, no padding. Needs `COPY_SRC`.
///
/// # Errors
/// [`GpuError::Validation`] for a format without a fixed texel size, or a wgpu error.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
    read_texture_layer(gpu, texture, 0)
}

/// Reads mip 0 of one layer, rows from the top, no padding; the depth aspect of depth formats.
///
/// # Errors
/// Same errors as [`read_texture`].
pub fn read_texture_layer(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    layer: u32,
) -> Result<Vec<u8>, GpuError> {
    let plane = TexturePlane::new(texture, layer)?;
    let mut bytes = Vec::with_capacity((plane.row_bytes * u64::from(plane.height)) as usize);
    let rows_per_band = plane.rows_per_band();
    for first_row in (0..plane.height).step_by(rows_per_band as usize) {
        let mut downloads = Downloads::new(gpu);
        let end = plane.height.min(first_row + rows_per_band);
        downloads.rows(gpu, &plane, first_row..end)?;
        downloads.start(gpu)?.take_into(gpu, &mut [&mut bytes])?;
    }
    Ok(bytes)
}

/// Reads a whole buffer as values of `T`; a remainder shorter than one `T` is dropped. Needs `COPY_SRC`.
///
/// # Errors
/// A wgpu error of the copy.
pub fn read_buffer<T: Pod>(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<T>, GpuError> {
    if buffer.size() == 0 {
        return Ok(Vec::new());
    }
    let mut downloads = Downloads::new(gpu);
    downloads.buffer(gpu, buffer)?;
    let mut bytes = Vec::new();
    downloads.start(gpu)?.take_into(gpu, &mut [&mut bytes])?;
    Ok(values(&bytes))
}

/// Bytes as values of `T`; a remainder shorter than one `T` is dropped.
pub fn values<T: Pod>(bytes: &[u8]) -> Vec<T> {
    let whole = bytes.len() - bytes.len() % size_of::<T>().max(1);
    bytemuck::pod_collect_to_vec(&bytes[..whole])
}

/// Mip 0 of one or more layers of a texture.
struct TexturePlane<'a> {
    texture: &'a wgpu::Texture,
    layer: u32,
    layers: u32,
    width: u32,
    height: u32,
    row_bytes: u64,
}

impl<'a> TexturePlane<'a> {
    fn new(texture: &'a wgpu::Texture, layer: u32) -> Result<Self, GpuError> {
        let format = texture.format();
        let texel_bytes = format.block_copy_size(Some(aspect(format)));
        let texel_bytes = texel_bytes.ok_or_else(|| {
            GpuError::Validation(format!("textures of format {format:?} cannot be read back"))
        })?;
        let width = texture.width();
        Ok(Self {
            texture,
            layer,
            layers: 1,
            width,
            height: texture.height(),
            row_bytes: u64::from(width) * u64::from(texel_bytes),
        })
    }

    /// Bytes of a row in a staging buffer, with the padding that WebGPU requires.
    fn padded_bytes(&self) -> u64 {
        let alignment = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT.into();
        self.row_bytes.next_multiple_of(alignment)
    }

    fn rows_per_band(&self) -> u32 {
        if self.texture.format().has_depth_aspect() {
            // WebGPU forbids copying part of a depth texture.
            self.height
        } else {
            (MAX_BAND_BYTES / self.padded_bytes()).clamp(1, self.height.into()) as u32
        }
    }
}

fn aspect(format: wgpu::TextureFormat) -> wgpu::TextureAspect {
    if format.has_depth_aspect() {
        wgpu::TextureAspect::DepthOnly
    } else {
        wgpu::TextureAspect::All
    }
}

/// A batch of readback copies, submitted together.
pub struct Downloads {
    encoder: wgpu::CommandEncoder,
    copies: Vec<Copy>,
}

/// Layout of one copy in its staging buffer.
struct Copy {
    staging: wgpu::Buffer,
    /// Bytes per row, without and with padding.
    row_bytes: [u64; 2],
}

impl Downloads {
    /// Empty batch.
    pub fn new(gpu: &Gpu) -> Self {
        let label = Some("readback");
        Self {
            encoder: (gpu.device).create_command_encoder(&wgpu::CommandEncoderDescriptor { label }),
            copies: Vec::new(),
        }
    }

    /// Adds a copy of mip 0 of a texture, its layers one after another, each laid out as by [`read_texture`].
    ///
    /// # Errors
    /// Same errors as [`read_texture`].
    pub fn texture(&mut self, gpu: &Gpu, texture: &wgpu::Texture) -> Result<(), GpuError> {
        let plane = TexturePlane {
            layers: texture.depth_or_array_layers(),
            ..TexturePlane::new(texture, 0)?
        };
        self.rows(gpu, &plane, 0..plane.height)
    }

    /// Adds a copy of a whole buffer, which must not be empty.
    ///
    /// # Errors
    /// A wgpu error of the staging buffer.
    pub fn buffer(&mut self, gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<(), GpuError> {
        let size = buffer.size();
        let staging = staging_buffer(gpu, size)?;
        self.encoder
            .copy_buffer_to_buffer(buffer, 0, &staging, 0, size);
        self.copies.push(Copy {
            staging,
            row_bytes: [size; 2],
        });
        Ok(())
    }

    fn rows(
        &mut self,
        gpu: &Gpu,
        plane: &TexturePlane,
        rows: std::ops::Range<u32>,
    ) -> Result<(), GpuError> {
        let padded = plane.padded_bytes();
        let num_rows = rows.end - rows.start;
        let staging = staging_buffer(gpu, padded * u64::from(num_rows) * u64::from(plane.layers))?;
        self.encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                texture: plane.texture,
                mip_level: 0,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: rows.start,
                    z: plane.layer,
                },
                aspect: aspect(plane.texture.format()),
            },
            wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded as u32),
                    rows_per_image: Some(num_rows),
                },
            },
            wgpu::Extent3d {
                width: plane.width,
                height: num_rows,
                depth_or_array_layers: plane.layers,
            },
        );
        self.copies.push(Copy {
            staging,
            row_bytes: [plane.row_bytes, padded],
        });
        Ok(())
    }

    /// Submits the copies without waiting; later submissions may overwrite their sources.
    ///
    /// # Errors
    /// A wgpu error of the submission.
    pub fn start(self, gpu: &Gpu) -> Result<Pending, GpuError> {
        let submission = gpu.submit(self.encoder)?;
        let (sender, answers) = channel();
        for copy in &self.copies {
            let sender = sender.clone();
            copy.staging
                .map_async(wgpu::MapMode::Read, .., move |result| {
                    // The receiver is gone if `Pending` was dropped.
                    let _ = sender.send(result);
                    wake();
                });
        }
        Ok(Pending {
            copies: self.copies,
            submission,
            answers,
        })
    }
}

/// Submitted copies. Dropping them discards the results.
pub struct Pending {
    copies: Vec<Copy>,
    submission: wgpu::SubmissionIndex,
    answers: Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Pending {
    /// Waits for the copies, but not for later submissions, and returns the bytes of each without
    /// padding, in order.
    ///
    /// # Errors
    /// A lost or unresponsive device.
    pub fn take(self, gpu: &Gpu) -> Result<Vec<Vec<u8>>, GpuError> {
        let mut all = vec![Vec::new(); self.copies.len()];
        let mut outputs: Vec<_> = all.iter_mut().collect();
        self.take_into(gpu, &mut outputs)?;
        Ok(all)
    }

    /// Appends the bytes of each copy to its output.
    fn take_into(self, gpu: &Gpu, outputs: &mut [&mut Vec<u8>]) -> Result<(), GpuError> {
        let lost = |why: String| GpuError::Lost(format!("results could not be read back: {why}"));
        gpu.wait_for(&self.submission)?;
        for _ in &self.copies {
            // Another thread's wait may run the callback shortly after this wait returns.
            let answer = receive(&self.answers, ANSWER_TIMEOUT);
            answer
                .map_err(|error| error.to_string())
                .and_then(|mapped| mapped.map_err(|error| error.to_string()))
                .map_err(lost)?;
        }
        for (copy, output) in self.copies.iter().zip(outputs) {
            let view = copy.staging.get_mapped_range(..);
            let view = view.map_err(|error| lost(error.to_string()))?;
            let [row_bytes, padded] = copy.row_bytes.map(|bytes| bytes as usize);
            output.reserve(view.len() / padded.max(1) * row_bytes);
            for row in view.chunks_exact(padded.max(1)) {
                output.extend_from_slice(&row[..row_bytes]);
            }
            drop(view);
            copy.staging.unmap();
        }
        Ok(())
    }
}

fn staging_buffer(gpu: &Gpu, size: u64) -> Result<wgpu::Buffer, GpuError> {
    gpu.check_buffer_size("reading results back", size)?;
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
    gpu.scoped("reading results back", || {
        gpu.buffer("readback", size, usage)
    })
}
