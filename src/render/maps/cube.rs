//! Textures of captured cube maps and boxes of faces.

use glam::Vec3;

use reflet_base::math::Bounds;
use reflet_gpu::{Gpu, GpuError};
use reflet_world::World;

/// Number of faces of a cube map or of a box.
pub const FACES: u32 = 6;
/// Bytes of a texel that holds a hit: its distance or depth, instance and triangle.
pub const HIT_BYTES: u64 = 16;
/// Format of the maps' hits.
pub const HITS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Maximum size of all maps of a method, bytes.
pub const MAX_MAP_BYTES: u64 = 2 << 30;

/// Number of texels of so many faces of this width.
pub fn texels(faces: u32, face_px: u32) -> u64 {
    u64::from(faces) * u64::from(face_px).pow(2)
}

/// Bounds of all instances that never move; a point at the origin where all move.
pub fn still_bounds(world: &World) -> Bounds {
    let still = world.instances.iter().filter(|i| !i.dynamic);
    let bounds = still.fold(Bounds::EMPTY, |all, i| all.union(world.bounds_of(i)));
    match bounds.is_empty() {
        true => Bounds::around([Vec3::ZERO]),
        false => bounds,
    }
}

/// View of all layers and levels.
pub fn whole(texture: &wgpu::Texture, dimension: wgpu::TextureViewDimension) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(dimension),
        ..Default::default()
    })
}

/// View of all layers of a level.
pub fn level_view(texture: &wgpu::Texture, level: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        base_mip_level: level,
        mip_level_count: Some(1),
        ..Default::default()
    })
}

/// Texture of square faces, given by their width in pixels and their number, with these levels.
///
/// # Errors
/// Exhausted memory.
pub fn texture(
    gpu: &Gpu,
    label: &str,
    format: wgpu::TextureFormat,
    (face_px, layers): (u32, u32),
    levels: u32,
) -> Result<wgpu::Texture, GpuError> {
    gpu.scoped("cube maps", || {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: face_px,
                height: face_px,
                depth_or_array_layers: layers,
            },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    })
}
