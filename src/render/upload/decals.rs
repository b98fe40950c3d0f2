//! Decals in their layout in shaders: one uniform block with the decals and the sets of them that instances show.

use bytemuck::{Pod, Zeroable};

use reflet_gpu::Gpu;
use reflet_scene::desc::{DecalChanges, DecalDesc};
use reflet_world::{Decal, DecalMask, Decals, World};

use super::instance_records::rows;
use crate::{
    buffers::frame_uniforms::empty_uniform,
    layout::{
        gpu_decal::{DECAL_COLOR, DECAL_METALLIC, DECAL_NORMAL, DECAL_ROUGHNESS, GpuDecal},
        gpu_struct::Shared as _,
        types::flag,
    },
};

/// Least range of cosines in which a decal fades: a hard border.
const LEAST_FADE: f32 = 1e-4;

/// The uniform block of all decals, always of full size.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct DecalBlock {
    decals: [GpuDecal; DecalDesc::MOST],
    sets: [DecalMask; Decals::MOST_SETS],
}

const _: () = assert!(
    size_of::<DecalBlock>() <= 1 << 16,
    "uniform blocks have 64 KiB"
);

/// The decals of a scene on the GPU.
#[derive(Clone, Debug)]
pub struct GpuDecals(wgpu::Buffer);

impl GpuDecals {
    /// Uploads the decals of a world; `None` if it has none.
    pub fn new(gpu: &Gpu, world: &World) -> Option<Self> {
        let decals = &world.decals;
        (!decals.list.is_empty()).then(|| {
            let buffer = empty_uniform(gpu, "decals", size_of::<DecalBlock>());
            let sets: &[u8] = bytemuck::cast_slice(&decals.sets);
            let after = size_of::<[GpuDecal; DecalDesc::MOST]>() as u64;
            gpu.queue.write_buffer(&buffer, after, sets);
            let new = Self(buffer);
            new.update(gpu, world);
            new
        })
    }

    /// Uploads the places of decals that moved.
    pub fn update(&self, gpu: &Gpu, world: &World) {
        let decals: Vec<_> = world.decals.list.iter().map(gpu_decal).collect();
        let bytes = bytemuck::cast_slice(&decals);
        gpu.queue.write_buffer(&self.0, 0, bytes);
    }

    /// Binding for shaders.
    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        self.0.as_entire_binding()
    }

    /// Size, bytes.
    pub fn bytes(&self) -> u64 {
        self.0.size()
    }
}

fn gpu_decal(decal: &Decal) -> GpuDecal {
    let cosine = |deg: f32| deg.max(0.0).to_radians().cos();
    let least_cosine = cosine(decal.max_angle_deg);
    let full = cosine(decal.max_angle_deg - decal.fade_deg);
    let DecalChanges {
        color,
        metallic,
        roughness,
        normal,
    } = decal.changes;
    GpuDecal {
        box_from_world: rows(&decal.world_from_box().inverse()),
        size: decal.size.to_array(),
        opacity: decal.opacity,
        material: decal.material as u32,
        changes: flag(color, DECAL_COLOR)
            | flag(metallic, DECAL_METALLIC)
            | flag(roughness, DECAL_ROUGHNESS)
            | flag(normal, DECAL_NORMAL),
        least_cosine,
        per_cosine: 1.0 / (full - least_cosine).max(LEAST_FADE),
        ..GpuDecal::ZERO
    }
}
