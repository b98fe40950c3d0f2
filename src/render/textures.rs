//! Texture pools: images of about one size share a 2D array, resampled to the array's size so that
//! hardware wrapping and mips stay right.

use rayon::prelude::*;

use crate::{
    gpu::{Gpu, GpuError},
    world::{Texture, World, Wrap, texture::LARGEST_KEPT_PX},
};

/// Edge of the smallest pool's images, pixels; each further pool doubles it.
pub const SMALLEST_POOL_PX: u32 = 512;
/// Edge of each pool's images, pixels.
pub const POOL_PX: [u32; 3] = [SMALLEST_POOL_PX, 2 * SMALLEST_POOL_PX, 4 * SMALLEST_POOL_PX];

const _: () = assert!(POOL_PX[2] == LARGEST_KEPT_PX);

/// Sampling mode of a texture's materials; of the last one where they differ.
#[derive(Clone, Copy, Debug, Default)]
struct Sampling {
    /// Nearest magnification: texels must stay sharp.
    nearest: bool,
    wrap: [Wrap; 2],
}

/// Pool and layer of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoolSlot {
    /// Index into [`POOL_PX`].
    pub pool: u32,
    /// Layer of its array.
    pub layer: u32,
}

/// All images of a scene on the GPU.
#[derive(Clone, Debug)]
pub struct Pools {
    /// Per pool: its linear view and its sRGB view.
    pub views: Vec<[wgpu::TextureView; 2]>,
    /// Parallel to [`World::textures`].
    pub slots: Vec<PoolSlot>,
    /// Bytes of all pools with their mips.
    pub bytes: u64,
}

impl Pools {
    /// Uploads every texture of the world.
    ///
    /// # Errors
    /// More images of a size than array layers, or a wgpu error.
    pub fn new(gpu: &Gpu, world: &World) -> Result<Self, GpuError> {
        let slots = assign_slots(&world.textures);
        let samplings = samplings(world);
        let mut pools = Self {
            views: Vec::new(),
            slots,
            bytes: 0,
        };
        for (pool, &px) in POOL_PX.iter().enumerate() {
            let members: Vec<usize> = (0..world.textures.len())
                .filter(|&i| pools.slots[i].pool == pool as u32)
                .collect();
            let array = pools.array(gpu, px, members.len() as u32)?;
            for batch in members.chunks(4) {
                let chains: Vec<Vec<Vec<u8>>> = batch
                    .par_iter()
                    .map(|&i| mip_chain(&world.textures[i], px, samplings[i]))
                    .collect();
                for (&i, chain) in batch.iter().zip(&chains) {
                    upload(gpu, &array, pools.slots[i].layer, px, chain);
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
        // A pool without images is one texel, so that its binding exists.
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

/// The smallest pool without downsampling, else the largest; layers in order.
pub fn assign_slots(textures: &[Texture]) -> Vec<PoolSlot> {
    let mut next = [0; POOL_PX.len()];
    let place = |texture: &Texture| {
        let edge = texture.width.max(texture.height);
        let pool = POOL_PX
            .iter()
            .position(|&px| edge <= px)
            .unwrap_or(POOL_PX.len() - 1);
        next[pool] += 1;
        PoolSlot {
            pool: pool as u32,
            layer: next[pool] - 1,
        }
    };
    textures.iter().map(place).collect()
}

/// Repeat/repeat, repeat/clamp, clamp/repeat, clamp/clamp along u and v.
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

/// Resampling of each texture to its pool's size.
fn samplings(world: &World) -> Vec<Sampling> {
    let mut samplings = vec![Sampling::default(); world.textures.len()];
    for material in &world.materials {
        for slot in material.slots().into_iter().flatten() {
            let sampling = &mut samplings[slot.texture];
            sampling.nearest |= slot.nearest;
            sampling.wrap = slot.wrap;
        }
    }
    samplings
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

/// The image at `px` × `px` and every halving of it.
fn mip_chain(texture: &Texture, px: u32, sampling: Sampling) -> Vec<Vec<u8>> {
    let base = if (texture.width, texture.height) == (px, px) {
        texture.rgba.clone()
    } else {
        resampled(texture, px, sampling)
    };
    let mut chain = vec![base];
    let mut edge = px;
    while edge > 1 {
        let next = box_downsampled(&chain[chain.len() - 1], edge, texture.srgb);
        chain.push(next);
        edge /= 2;
    }
    chain
}

/// The image at `px` × `px`: nearest texels, or as the hardware would magnify it, wrapping
/// included; larger ones are halved first.
fn resampled(texture: &Texture, px: u32, sampling: Sampling) -> Vec<u8> {
    let mut size = [texture.width, texture.height];
    let mut source = std::borrow::Cow::Borrowed(&texture.rgba);
    if sampling.nearest {
        return image_from(px, |x, y| {
            let at = [x * size[0] / px, y * size[1] / px];
            texel(&source, size, at)
        });
    }
    while size[0] > px || size[1] > px {
        let factor = size.map(|edge| if edge > px { 2 } else { 1 });
        let next = size.map(|edge| edge.min(edge.div_ceil(2).max(px)));
        let next = [0, 1].map(|i| if factor[i] == 2 { next[i] } else { size[i] });
        source = std::borrow::Cow::Owned(bilinear_resized(
            &source,
            size,
            next,
            sampling,
            texture.srgb,
        ));
        size = next;
    }
    bilinear_resized(&source, size, [px, px], sampling, texture.srgb)
}

fn texel(rgba: &[u8], size: [u32; 2], at: [u32; 2]) -> [u8; 4] {
    let i = 4 * (at[1] as usize * size[0] as usize + at[0] as usize);
    [rgba[i], rgba[i + 1], rgba[i + 2], rgba[i + 3]]
}

fn image_from(px: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    (0..px)
        .flat_map(|y| (0..px).map(move |x| (x, y)))
        .flat_map(|(x, y)| pixel(x, y))
        .collect()
}

/// Bilinear, between texel centers; across the border by the wrap mode; colors in linear light.
fn bilinear_resized(
    rgba: &[u8],
    size: [u32; 2],
    to: [u32; 2],
    sampling: Sampling,
    srgb: bool,
) -> Vec<u8> {
    let taps = |axis: usize| -> Vec<([u32; 2], f32)> {
        let edge = i64::from(size[axis]);
        let place = |i: i64| match sampling.wrap[axis] {
            Wrap::Repeat => i.rem_euclid(edge) as u32,
            // Mirrored at the border, the next texel is the last one again.
            Wrap::Clamp | Wrap::Mirror => i.clamp(0, edge - 1) as u32,
        };
        let tap = |x: u32| {
            let at = (x as f32 + 0.5) * size[axis] as f32 / to[axis] as f32 - 0.5;
            let low = at.floor();
            ([place(low as i64), place(low as i64 + 1)], at - low)
        };
        (0..to[axis]).map(tap).collect()
    };
    let (across, down) = (taps(0), taps(1));
    let tables = SrgbTables::get();
    let mut out = Vec::with_capacity(to[0] as usize * to[1] as usize * 4);
    for (ys, fy) in &down {
        for (xs, fx) in &across {
            let corners = [
                [xs[0], ys[0]],
                [xs[1], ys[0]],
                [xs[0], ys[1]],
                [xs[1], ys[1]],
            ];
            let corners = corners.map(|at| texel(rgba, size, at));
            let weights = [
                (1.0 - fx) * (1.0 - fy),
                fx * (1.0 - fy),
                (1.0 - fx) * fy,
                fx * fy,
            ];
            for c in 0..4 {
                let is_light = srgb && c < 3;
                let value = |code: u8| {
                    if is_light {
                        f32::from(tables.light[code as usize]) / 65535.0
                    } else {
                        f32::from(code) / 255.0
                    }
                };
                let mean: f32 = corners
                    .iter()
                    .zip(weights)
                    .map(|(t, w)| value(t[c]) * w)
                    .sum();
                out.push(if is_light {
                    tables.code[(mean * 4095.0).round() as usize]
                } else {
                    (mean * 255.0).round() as u8
                });
            }
        }
    }
    out
}

/// 2×2 box filter; colors are averaged in linear light.
fn box_downsampled(rgba: &[u8], edge: u32, srgb: bool) -> Vec<u8> {
    let edge = edge as usize;
    let half = edge / 2;
    let mut out = Vec::with_capacity(half * half * 4);
    let tables = srgb.then(SrgbTables::get);
    for y in 0..half {
        for x in 0..half {
            let first = (2 * y * edge + 2 * x) * 4;
            for c in 0..4 {
                let at =
                    [first, first + 4, first + edge * 4, first + edge * 4 + 4].map(|i| rgba[i + c]);
                out.push(match tables {
                    Some(tables) if c < 3 => tables.mean(at),
                    _ => ((at.iter().map(|&v| u32::from(v)).sum::<u32>() + 2) / 4) as u8,
                });
            }
        }
    }
    out
}

/// sRGB to 16-bit linear light and back.
struct SrgbTables {
    light: [u16; 256],
    code: Vec<u8>,
}

impl SrgbTables {
    fn get() -> &'static Self {
        static TABLES: std::sync::OnceLock<SrgbTables> = std::sync::OnceLock::new();
        TABLES.get_or_init(|| {
            let light = std::array::from_fn(|i| {
                (crate::math::linear_from_srgb(i as f32 / 255.0) * 65535.0).round() as u16
            });
            let code = (0..=4095u32)
                .map(|i| (crate::math::srgb_from_linear(i as f32 / 4095.0) * 255.0).round() as u8)
                .collect();
            Self { light, code }
        })
    }

    fn mean(&self, codes: [u8; 4]) -> u8 {
        let sum: u32 = codes
            .iter()
            .map(|&c| u32::from(self.light[c as usize]))
            .sum();
        self.code[(sum / 64).min(4095) as usize]
    }
}
