//! The panorama of the environment on the GPU: its texels, and the density table with its cones for sampling.

use reflet_gpu::{Gpu, GpuError};
use reflet_world::environment::Panorama;

/// A panorama on the GPU.
#[derive(Clone, Debug)]
pub struct GpuPanorama {
    texels: wgpu::TextureView,
    density: wgpu::TextureView,
    cones: wgpu::TextureView,
    sampler: wgpu::Sampler,
    /// Size of all textures, bytes.
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
        let cones = &panorama.density.cones;
        let density = pyramid(gpu, edge, levels, wgpu::TextureFormat::R32Float)?;
        let most_cones = 1 << (cones.len() - 1);
        let bright = pyramid(gpu, most_cones, cones, wgpu::TextureFormat::Rgba32Float)?;
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("panorama sampler"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let squares: usize = levels.iter().map(Vec::len).sum();
        let cones: usize = panorama.density.cones.iter().map(Vec::len).sum();
        Ok(Self {
            texels: view(&texels),
            density: view(&density),
            cones: view(&bright),
            sampler,
            bytes: 8 * u64::from(width) * u64::from(height) + (4 * squares + 16 * cones) as u64,
        })
    }

    /// The resource with this name in group 0; `None` if it does not belong to the panorama.
    pub fn resource(&self, name: &str) -> Option<wgpu::BindingResource<'_>> {
        match name {
            "panorama" => Some(wgpu::BindingResource::TextureView(&self.texels)),
            "panorama_density" => Some(wgpu::BindingResource::TextureView(&self.density)),
            "panorama_cones" => Some(wgpu::BindingResource::TextureView(&self.cones)),
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

/// A square texture of all levels of a pyramid, from `edge` texels down to one.
fn pyramid<T: bytemuck::Pod>(
    gpu: &Gpu,
    edge: u32,
    levels: &[Vec<T>],
    format: wgpu::TextureFormat,
) -> Result<wgpu::Texture, GpuError> {
    let texture = texture(gpu, [edge, edge], levels.len() as u32, format)?;
    for (level, squares) in levels.iter().enumerate() {
        upload(gpu, &texture, level as u32, bytemuck::cast_slice(squares));
    }
    Ok(texture)
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
