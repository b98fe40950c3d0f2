//! The panorama of the environment on the GPU: its texels, and the densities and cones of squares for sampling.

use reflet_gpu::{Gpu, GpuError};
use reflet_world::environment::{CONE_LEVELS, Density, Panorama};

use crate::buffers::texel_array::TexelArray;

/// Number of cones of all levels: (4^levels − 1) / 3.
pub const MOST_CONES: usize = ((1 << (2 * CONE_LEVELS)) - 1) / 3;

/// A panorama on the GPU.
#[derive(Clone, Debug)]
pub struct GpuPanorama {
    texels: wgpu::TextureView,
    squares: TexelArray,
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
        let texels = texture(gpu, [width, height])?;
        gpu.write_texture(&texels, bytemuck::cast_slice(&panorama.texels));
        let squares = squares(&panorama.density);
        let squares = TexelArray::new(gpu, "panorama_squares", squares.into_iter())?;
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("panorama sampler"),
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Ok(Self {
            texels: texels.create_view(&wgpu::TextureViewDescriptor::default()),
            bytes: 8 * u64::from(width) * u64::from(height) + squares.size(),
            squares,
            sampler,
        })
    }

    /// The resource with this name in group 0; `None` if it does not belong to the panorama.
    pub fn resource(&self, name: &str) -> Option<wgpu::BindingResource<'_>> {
        match name {
            "panorama" => Some(wgpu::BindingResource::TextureView(&self.texels)),
            "panorama_squares" => Some(self.squares.resource()),
            "panorama_sampler" => Some(wgpu::BindingResource::Sampler(&self.sampler)),
            _ => None,
        }
    }
}

/// Vectors by which shaders choose squares: cones of coarse ones, then for each square the densities of the four within
/// it. Coarser levels come first, so that the place of a square depends on its own level alone.
fn squares(density: &Density) -> Vec<[f32; 4]> {
    let cones = density.cones.iter().rev().flatten();
    let mut all: Vec<_> = cones.map(glam::Vec4::to_array).collect();
    all.resize(MOST_CONES, [0.0; 4]);
    let finer = density.levels.iter().rev().skip(1);
    for (edge, level) in (1..).map(|k| 1 << k).zip(finer) {
        let half = edge / 2;
        all.extend((0..half * half).map(|i| {
            let first = i / half * 2 * edge + i % half * 2;
            [first, first + 1, first + edge, first + edge + 1].map(|i| level[i])
        }));
    }
    if density.levels.len() == 1 {
        all.push([density.levels[0][0]; 4]);
    }
    all
}

fn texture(gpu: &Gpu, [width, height]: [u32; 2]) -> Result<wgpu::Texture, GpuError> {
    let format = wgpu::TextureFormat::Rgba16Float;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    gpu.scoped("panorama", || {
        gpu.texture("panorama", [width, height, 1], format, usage)
    })
}
