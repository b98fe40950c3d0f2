//! The panorama of the environment on the GPU: its texels, and the density table with its cones for sampling.

use reflet_gpu::{Gpu, GpuError};
use reflet_world::environment::{CONE_LEVELS, Panorama};

use crate::buffers::frame_uniforms::uniform;

/// Number of cones of all levels: (4^levels − 1) / 3.
pub const MOST_CONES: usize = ((1 << (2 * CONE_LEVELS)) - 1) / 3;

/// A panorama on the GPU.
#[derive(Clone, Debug)]
pub struct GpuPanorama {
    texels: wgpu::TextureView,
    density: wgpu::TextureView,
    cones: wgpu::Buffer,
    sampler: wgpu::Sampler,
    /// Size of all textures and buffers, bytes.
    pub bytes: u64,
}

impl GpuPanorama {
    /// Uploads a panorama.
    ///
    /// # Errors
    /// A side past the adapter's limit, or a wgpu error.
    pub fn new(gpu: &Gpu, panorama: &Panorama) -> Result<Self, GpuError> {
        let (width, height) = (panorama.width, panorama.height);
        gpu.check_texture_size("the panorama", width, height)?;
        let levels = &panorama.density.levels;
        let edge = panorama.density.edge();
        let texels = texture(gpu, [width, height], 1, wgpu::TextureFormat::Rgba16Float)?;
        upload(gpu, &texels, 0, bytemuck::cast_slice(&panorama.texels));
        let count = levels.len() as u32;
        let density = texture(gpu, [edge, edge], count, wgpu::TextureFormat::R32Float)?;
        for (level, squares) in levels.iter().enumerate() {
            upload(gpu, &density, level as u32, bytemuck::cast_slice(squares));
        }
        // Coarser levels first, so that the place of a cone depends on its own level alone.
        let mut cones = panorama
            .density
            .cones
            .iter()
            .rev()
            .cloned()
            .collect::<Vec<_>>()
            .concat();
        cones.resize(MOST_CONES, glam::Vec4::ZERO);
        let cones = uniform(gpu, "panorama_cones", bytemuck::cast_slice(&cones));
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("panorama sampler"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let squares: usize = levels.iter().map(Vec::len).sum();
        let tables = 4 * squares as u64 + cones.size();
        Ok(Self {
            texels: view(&texels),
            density: view(&density),
            cones,
            sampler,
            bytes: 8 * u64::from(width) * u64::from(height) + tables,
        })
    }

    /// The resource with this name in group 0; `None` if it does not belong to the panorama.
    pub fn resource(&self, name: &str) -> Option<wgpu::BindingResource<'_>> {
        match name {
            "panorama" => Some(wgpu::BindingResource::TextureView(&self.texels)),
            "panorama_density" => Some(wgpu::BindingResource::TextureView(&self.density)),
            "panorama_cones" => Some(self.cones.as_entire_binding()),
            "panorama_sampler" => Some(wgpu::BindingResource::Sampler(&self.sampler)),
            _ => None,
        }
    }
}

fn texture(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    mip_level_count: u32,
    format: wgpu::TextureFormat,
) -> Result<wgpu::Texture, GpuError> {
    gpu.scoped("panorama", || {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("panorama"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    })
}

fn upload(gpu: &Gpu, texture: &wgpu::Texture, mip_level: u32, bytes: &[u8]) {
    let size = texture
        .size()
        .mip_level_size(mip_level, texture.dimension());
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes.len() as u32 / size.height),
            rows_per_image: Some(size.height),
        },
        size,
    );
}
