//! Textures and buffers back to the CPU, tightly packed.

use bytemuck::Pod;

use super::context::{Gpu, GpuError};

/// Largest staging buffer: a 16384 × 16384 float picture is read in bands of rows.
const MAX_BAND_BYTES: u64 = 64 << 20;

/// Mip 0, layer 0 of a 2D texture, rows from the top, no padding. Needs `COPY_SRC`.
///
/// # Errors
/// [`GpuError::Validation`] for a format without a fixed texel size, or what wgpu says.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
    read_texture_layer(gpu, texture, 0, 0)
}

/// One mip of one layer, rows from the top, no padding. Depth formats give their depth.
///
/// # Errors
/// As [`read_texture`].
pub fn read_texture_layer(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    mip_level: u32,
    layer: u32,
) -> Result<Vec<u8>, GpuError> {
    let format = texture.format();
    let aspect = if format.has_depth_aspect() {
        wgpu::TextureAspect::DepthOnly
    } else {
        wgpu::TextureAspect::All
    };
    let texel_bytes = format.block_copy_size(Some(aspect)).ok_or_else(|| {
        GpuError::Validation(format!("textures of format {format:?} cannot be read back"))
    })?;
    let width = (texture.width() >> mip_level).max(1);
    let height = (texture.height() >> mip_level).max(1);
    let row_bytes = u64::from(width) * u64::from(texel_bytes);
    let padded = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT.into());
    // A depth texture is copied whole: WebGPU forbids copying part of one.
    let rows_per_band = if format.has_depth_aspect() {
        height
    } else {
        (MAX_BAND_BYTES / padded).clamp(1, height.into()) as u32
    };
    let mut bytes = Vec::with_capacity((row_bytes * u64::from(height)) as usize);
    for first_row in (0..height).step_by(rows_per_band as usize) {
        let num_rows = rows_per_band.min(height - first_row);
        let staging = staging_buffer(gpu, padded * u64::from(num_rows))?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: first_row,
                    z: layer,
                },
                aspect,
            },
            wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded as u32),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d {
                width,
                height: num_rows,
                depth_or_array_layers: 1,
            },
        );
        let band = map(gpu, encoder, &staging)?;
        for row in band.chunks_exact(padded as usize) {
            bytes.extend_from_slice(&row[..row_bytes as usize]);
        }
    }
    Ok(bytes)
}

/// A whole buffer as values of `T`; a rest shorter than one `T` is dropped. Needs `COPY_SRC`.
///
/// # Errors
/// What wgpu says about the copy.
pub fn read_buffer<T: Pod>(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<T>, GpuError> {
    let size = buffer.size();
    if size == 0 {
        return Ok(Vec::new());
    }
    let staging = staging_buffer(gpu, size)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size);
    let bytes = map(gpu, encoder, &staging)?;
    let whole = bytes.len() - bytes.len() % size_of::<T>().max(1);
    Ok(bytemuck::pod_collect_to_vec(&bytes[..whole]))
}

fn staging_buffer(gpu: &Gpu, size: u64) -> Result<wgpu::Buffer, GpuError> {
    gpu.check_buffer_size("reading results back", size)?;
    gpu.scoped("reading results back", || {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    })
}

/// Submits the copy into `staging`, waits, and takes the bytes.
fn map(
    gpu: &Gpu,
    encoder: wgpu::CommandEncoder,
    staging: &wgpu::Buffer,
) -> Result<Vec<u8>, GpuError> {
    gpu.submit(encoder)?;
    let (sender, receiver) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver lives until the wait below is over.
        let _ = sender.send(result);
    });
    gpu.wait()?;
    let lost = |why: String| GpuError::Lost(format!("results could not be read back: {why}"));
    // Another thread's wait may be what delivers the result, a moment after ours is over.
    match receiver.recv_timeout(std::time::Duration::from_secs(10)) {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(lost(error.to_string())),
        Err(error) => return Err(lost(error.to_string())),
    }
    let view = staging
        .get_mapped_range(..)
        .map_err(|error| lost(error.to_string()))?;
    let bytes = view.to_vec();
    drop(view);
    staging.unmap();
    Ok(bytes)
}
