//! Texture pools: images of similar size share a 2D array, resampled to the array's size so that hardware wrapping
//! and mips stay correct.

use std::collections::HashMap;

use rayon::prelude::*;

use reflet_gpu::{Gpu, GpuError};
use reflet_world::{
    Material, Texture, TextureRef, World,
    texture::{
        pool_size::{NUM_POOLS, PoolSizes, bytes_of_layer},
        resample::{Sampling, mip_chain},
    },
};

/// Texels of the images that are resampled at once.
const BATCH_TEXELS: usize = 4 * 2048 * 2048;

/// Number of bits of a mask of pools: bit 2k for pool k linear, bit 2k + 1 for pool k as sRGB.
pub const POOL_BITS: u32 = 2 * NUM_POOLS as u32;

/// Pool and layer of a resampled image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoolSlot {
    /// Index into [`PoolSizes::px`].
    pub pool: u32,
    /// Width and height of the pool's images, pixels.
    pub px: u32,
    /// Layer of the pool's array.
    pub layer: u32,
}

/// All images of a scene on the GPU.
#[derive(Clone, Debug)]
pub struct Pools {
    /// Per pool: its linear view and its sRGB view.
    pub views: Vec<[wgpu::TextureView; 2]>,
    /// Pool and layer of each image.
    pub layers: Layers,
    /// Size of all pools with their mips, bytes.
    pub bytes: u64,
}

impl Pools {
    /// Uploads every texture of the world.
    ///
    /// # Errors
    /// More images of one size than array layers, or a wgpu error.
    pub fn new(gpu: &Gpu, world: &World) -> Result<Self, GpuError> {
        let mut pools = Self {
            views: Vec::new(),
            layers: Layers::for_world(world),
            bytes: 0,
        };
        let images = pools.layers.images();
        for (pool, px) in pools.layers.sizes.px.into_iter().enumerate() {
            let members = images
                .iter()
                .filter(|(_, _, slot)| slot.pool == pool as u32);
            let members: Vec<_> = members.collect();
            let array = pools.array(gpu, px, members.len() as u32)?;
            for batch in members.chunks((BATCH_TEXELS / (px * px) as usize).clamp(1, 4)) {
                let chains: Vec<Vec<Vec<u8>>> = batch
                    .par_iter()
                    .map(|(i, sampling, _)| mip_chain(&world.textures[*i], px, *sampling))
                    .collect();
                for ((_, _, slot), chain) in batch.iter().zip(&chains) {
                    upload(gpu, &array, slot.layer, px, chain);
                }
                // Staging memory is freed once its copies are done.
                gpu.queue.submit([]);
                gpu.wait()?;
            }
            pools.views.push(views(&array));
        }
        Ok(pools)
    }

    fn array(&mut self, gpu: &Gpu, px: u32, layers: u32) -> Result<wgpu::Texture, GpuError> {
        let limit = gpu.limits.max_texture_array_layers;
        if layers > limit {
            return Err(GpuError::Limit {
                what: format!("the pool of {px}x{px} textures"),
                wanted: layers.into(),
                limit: limit.into(),
                unit: "images",
            });
        }
        // A pool without images has one texel, so that it can be bound.
        let (edge, mips) = if layers == 0 {
            (1, 1)
        } else {
            (px, px.ilog2() + 1)
        };
        let layers = layers.max(1);
        self.bytes += (0..mips)
            .map(|m| 4 * u64::from(layers) * u64::from(edge >> m).pow(2))
            .sum::<u64>();
        gpu.scoped("texture pool", || {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("texture pool"),
                size: wgpu::Extent3d {
                    width: edge,
                    height: edge,
                    depth_or_array_layers: layers,
                },
                mip_level_count: mips,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[wgpu::TextureFormat::Rgba8UnormSrgb],
            })
        })
    }
}

/// Samplers with repeat/repeat, repeat/clamp, clamp/repeat, clamp/clamp along u and v.
pub fn samplers(gpu: &Gpu) -> [wgpu::Sampler; 4] {
    use wgpu::AddressMode::{ClampToEdge as C, Repeat as R};
    [[R, R], [R, C], [C, R], [C, C]].map(|[u, v]| {
        gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("texture sampler"),
            address_mode_u: u,
            address_mode_v: v,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        })
    })
}

/// Layers of all images that materials sample: one for each way of resampling an image.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    sizes: PoolSizes,
    /// Pool index of each of [`World::textures`].
    pools: Vec<usize>,
    slots: HashMap<(usize, Sampling), PoolSlot>,
}

impl Layers {
    /// Assigns layers for a world, in the order of its materials.
    pub fn for_world(world: &World) -> Self {
        let sizes = PoolSizes::for_textures(&world.textures);
        let mut layers = Self {
            sizes,
            pools: (world.textures.iter())
                .map(|texture| sizes.pool_of(texture))
                .collect(),
            slots: HashMap::new(),
        };
        let mut next = [0; NUM_POOLS];
        for (slot, used) in uses(world) {
            let (key, pool) = layers.key(slot, &used, &world.textures);
            layers.slots.entry(key).or_insert_with(|| {
                next[pool] += 1;
                PoolSlot {
                    pool: pool as u32,
                    px: sizes.px[pool],
                    layer: next[pool] - 1,
                }
            });
        }
        layers
    }

    /// Key of a texture use, and its pool.
    fn key(
        &self,
        slot: usize,
        used: &TextureRef,
        textures: &[Texture],
    ) -> ((usize, Sampling), usize) {
        let pool = self.pools[used.texture];
        let sampling =
            Sampling::for_texture(slot, used, &textures[used.texture], self.sizes.px[pool]);
        ((used.texture, sampling), pool)
    }

    /// Pool and layer of a texture use, as `slot` of [`Material::slots`]; `None` if no material of the world used the
    /// image this way.
    pub fn slot(&self, slot: usize, used: &TextureRef, textures: &[Texture]) -> Option<PoolSlot> {
        self.slots.get(&self.key(slot, used, textures).0).copied()
    }

    /// Whether all texture uses of another world, with the same images, have layers.
    pub fn cover(&self, world: &World) -> bool {
        uses(world).all(|(slot, used)| self.slot(slot, &used, &world.textures).is_some())
    }

    /// Size of all layers with their mips, bytes.
    pub fn bytes(&self) -> u64 {
        let layers = self.slots.values();
        layers.map(|slot| bytes_of_layer(slot.px)).sum()
    }

    /// Image index, resampling and slot of each layer, ordered by pool and layer.
    fn images(&self) -> Vec<(usize, Sampling, PoolSlot)> {
        let slots = self.slots.iter();
        let mut images: Vec<_> = slots.map(|((i, how), slot)| (*i, *how, *slot)).collect();
        images.sort_by_key(|(_, _, slot)| (slot.pool, slot.layer));
        images
    }
}

/// All texture uses of a world, with their slots.
fn uses(world: &World) -> impl Iterator<Item = (usize, TextureRef)> {
    let slots = |m: &Material| m.slots().into_iter().enumerate();
    (world.materials.iter())
        .flat_map(move |m| slots(m).filter_map(|(slot, used)| Some((slot, used?))))
}

fn views(array: &wgpu::Texture) -> [wgpu::TextureView; 2] {
    [
        wgpu::TextureFormat::Rgba8Unorm,
        wgpu::TextureFormat::Rgba8UnormSrgb,
    ]
    .map(|format| {
        array.create_view(&wgpu::TextureViewDescriptor {
            format: Some(format),
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        })
    })
}

fn upload(gpu: &Gpu, array: &wgpu::Texture, layer: u32, px: u32, chain: &[Vec<u8>]) {
    for (mip, bytes) in chain.iter().enumerate() {
        let edge = px >> mip;
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: array,
                mip_level: mip as u32,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: 0,
                    z: layer,
                },
                aspect: wgpu::TextureAspect::All,
            },
            bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * edge),
                rows_per_image: Some(edge),
            },
            wgpu::Extent3d {
                width: edge,
                height: edge,
                depth_or_array_layers: 1,
            },
        );
    }
}
