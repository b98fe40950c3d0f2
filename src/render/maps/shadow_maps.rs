//! The shadow maps of lights with `shadow = "map"`.

use reflet_gpu::{Gpu, GpuError};

use crate::lighting::lights::{ShadowSizes, TEXEL_BYTES};

/// Format of every map.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Maximum size of all cube maps, and of all flat maps, bytes.
const MAX_MAP_BYTES: u64 = 4 << 30;

/// Shadow maps of a scene; without mapped shadows one texel large, so that they can be bound.
#[derive(Clone, Debug)]
pub struct ShadowMaps {
    /// Sizes and counts of the maps.
    pub sizes: ShadowSizes,
    /// View of all cube maps, as the shaders sample them.
    pub cubes: wgpu::TextureView,
    /// View of all flat maps.
    pub maps: wgpu::TextureView,
    /// Comparison sampler for reversed depth: lit where the receiver is not farther than the map's depth.
    pub sampler: wgpu::Sampler,
    /// Size of all maps, bytes.
    pub bytes: u64,
    /// Views of each face of each cube map, to render into.
    pub cube_layers: Vec<wgpu::TextureView>,
    /// Views of each flat map, to render into.
    pub map_layers: Vec<wgpu::TextureView>,
}

impl ShadowMaps {
    /// Creates the maps.
    ///
    /// # Errors
    /// More or larger maps than the adapter allows.
    pub fn new(gpu: &Gpu, sizes: ShadowSizes) -> Result<Self, GpuError> {
        let (cube_texture, cubes, cube_bytes) = array(
            gpu,
            sizes.cube_px,
            6 * sizes.cubes,
            wgpu::TextureViewDimension::CubeArray,
        )?;
        let (map_texture, maps, map_bytes) = array(
            gpu,
            sizes.map_px,
            sizes.maps,
            wgpu::TextureViewDimension::D2Array,
        )?;
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow sampler"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        Ok(Self {
            sizes,
            cubes,
            maps,
            sampler,
            bytes: cube_bytes + map_bytes,
            cube_layers: layers(&cube_texture, 6 * sizes.cubes),
            map_layers: layers(&map_texture, sizes.maps),
        })
    }

    /// The resource with this name in group 0, if there is one.
    pub fn resource(&self, name: &str) -> Option<wgpu::BindingResource<'_>> {
        match name {
            "shadow_cubes" => Some(wgpu::BindingResource::TextureView(&self.cubes)),
            "shadow_maps" => Some(wgpu::BindingResource::TextureView(&self.maps)),
            "shadow_sampler" => Some(wgpu::BindingResource::Sampler(&self.sampler)),
            _ => None,
        }
    }
}

fn array(
    gpu: &Gpu,
    px: u32,
    layers: u32,
    dimension: wgpu::TextureViewDimension,
) -> Result<(wgpu::Texture, wgpu::TextureView, u64), GpuError> {
    let limit = gpu.limits.max_texture_array_layers;
    if layers > limit {
        return Err(GpuError::Limit {
            what: "shadow = \"map\" (a point light takes six; use \"ray\" for some)".to_owned(),
            wanted: layers.into(),
            limit: limit.into(),
            unit: "shadow maps",
        });
    }
    let least = if dimension == wgpu::TextureViewDimension::CubeArray {
        6
    } else {
        1
    };
    let (px, count) = (px.max(1), layers.max(least));
    gpu.check_texture_size("a shadow map", px, px)?;
    let bytes = TEXEL_BYTES * u64::from(px) * u64::from(px) * u64::from(count);
    if bytes > MAX_MAP_BYTES {
        return Err(GpuError::Limit {
            what: format!(
                "{layers} shadow maps of {px}x{px} (lower shadow_px, or use shadow = \"ray\")"
            ),
            wanted: bytes,
            limit: MAX_MAP_BYTES,
            unit: "bytes",
        });
    }
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
        | wgpu::TextureUsages::TEXTURE_BINDING
        | wgpu::TextureUsages::COPY_SRC;
    let made = gpu.scoped("shadow maps", || {
        let texture = gpu.texture("shadow maps", [px, px, count], FORMAT, usage);
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            ..Default::default()
        });
        (texture, view)
    })?;
    Ok((made.0, made.1, bytes))
}

fn layers(texture: &wgpu::Texture, count: u32) -> Vec<wgpu::TextureView> {
    let layer = |base_array_layer| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    };
    (0..count).map(layer).collect()
}
