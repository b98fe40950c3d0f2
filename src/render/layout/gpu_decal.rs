//! A decal in its layout in shaders.

use reflet_scene::desc::DecalDesc;
use reflet_world::Decals;

use super::gpu_struct::gpu_struct;

gpu_struct! {
    /// A decal; see `shaders/lib/decals.wgsl`.
    pub struct GpuDecal = padded "Decal" {
        /// Rows of the transform from the world to the cube from -0.5 to 0.5 that is the box.
        box_from_world: [[f32; 4]; 3],
        /// Size of the box in meters of the decal's own space, in which its patterns lie.
        size: [f32; 3],
        /// Factor on its coverage.
        opacity: f32,
        /// Index of its material.
        material: u32,
        /// Properties that it changes: `DECAL_*`.
        changes: u32,
        /// Cosine of the largest angle to a surface's normal.
        least_cosine: f32,
        /// 1 / width of the interval of cosines above `least_cosine` in which it fades.
        per_cosine: f32,
    }
}

/// Bit of [`GpuDecal::changes`]: base color and emission.
pub const DECAL_COLOR: u32 = 1;
/// Bit of [`GpuDecal::changes`]: metalness.
pub const DECAL_METALLIC: u32 = 2;
/// Bit of [`GpuDecal::changes`]: roughness and reflectivity.
pub const DECAL_ROUGHNESS: u32 = 4;
/// Bit of [`GpuDecal::changes`]: normal.
pub const DECAL_NORMAL: u32 = 8;
/// Number of decals in the uniform block.
pub const MOST_DECALS: u32 = DecalDesc::MOST as u32;
/// Number of sets of decals in the uniform block.
pub const MOST_DECAL_SETS: u32 = Decals::MOST_SETS as u32;
/// First bit of an instance's flags that numbers its set of decals; 0: none.
pub const DECAL_SET_SHIFT: u32 = 16;
