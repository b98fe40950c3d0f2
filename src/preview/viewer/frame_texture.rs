//! The textures that the window samples: finished pictures, copied on the device, so that the
//! window never shows half a frame and keeps the last good one.

use std::sync::atomic::{AtomicU64, Ordering};

use reflet_gpu::{Gpu, GpuError, readback::read_texture};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A finished picture on the device; display color, sRGB.
#[derive(Clone, Debug)]
pub struct FrameTexture {
    /// Unique id; a new size makes a new texture.
    pub number: u64,
    /// View for sampling.
    pub view: wgpu::TextureView,
    /// Size, pixels.
    pub size: [u32; 2],
    texture: wgpu::Texture,
}

impl FrameTexture {
    fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        static NUMBER: AtomicU64 = AtomicU64::new(1);
        let usage = wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC;
        let texture = gpu.scoped("the shown picture", || {
            gpu.texture("shown", [size[0], size[1], 1], FORMAT, usage)
        })?;
        Ok(Self {
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            size,
            texture,
        })
    }

    /// Reuses `old` if it has this size, else creates a texture.
    ///
    /// # Errors
    /// Exhausted memory.
    pub fn of_size(gpu: &Gpu, old: Option<Self>, size: [u32; 2]) -> Result<Self, GpuError> {
        match old.filter(|texture| texture.size == size) {
            Some(texture) => Ok(texture),
            None => Self::new(gpu, size),
        }
    }

    /// Copies a texture of the same size and format.
    ///
    /// # Errors
    /// A lost device.
    pub fn copy(&self, gpu: &Gpu, from: &wgpu::Texture) -> Result<(), GpuError> {
        let label = Some("show");
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        encoder.copy_texture_to_texture(
            from.as_image_copy(),
            self.texture.as_image_copy(),
            self.texture.size(),
        );
        gpu.submit(encoder).map(drop)
    }

    /// Reads RGBA bytes, rows from the top.
    ///
    /// # Errors
    /// A lost device.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<u8>, GpuError> {
        read_texture(gpu, &self.texture)
    }

    /// Writes RGBA bytes.
    pub fn write(&self, gpu: &Gpu, rgba: &[u8]) {
        gpu.write_texture(&self.texture, rgba);
    }
}
