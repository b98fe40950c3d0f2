//! The fog of a scene, as shaders know it.

use reflet_world::World;

use super::gpu_struct::gpu_struct;

gpu_struct! {
    /// Fog; see `shaders/lib/fog.wgsl`.
    pub struct GpuFog = "Fog" {
        /// Corner of the box that homogeneous fog fills, meters.
        lowest: [f32; 3],
        /// Extinction coefficient, per meter.
        density: f32,
        /// Opposite corner of the box, meters.
        highest: [f32; 3],
        /// Height up to which the density is constant, meters.
        height_m: f32,
        /// Share of the light that meets the fog which it scatters.
        albedo: [f32; 3],
        /// Height in which the density falls by a factor of e, meters; 0: homogeneous fog in a box.
        falloff_m: f32,
        /// Mean cosine of the angle by which light is scattered.
        anisotropy: f32,
    }
}

impl GpuFog {
    /// The fog of a world, if it has any.
    pub fn from_world(world: &World) -> Option<Self> {
        let fog = world.environment.fog()?;
        let corners = match world.environment.fog_box {
            corners if corners.is_empty() => world.fog_box(), // of a world that no scene text made
            corners => corners,
        };
        Some(Self {
            lowest: corners.min.to_array(),
            density: fog.density,
            highest: corners.max.to_array(),
            height_m: fog.height_m,
            albedo: fog.color.to_array(),
            falloff_m: fog.falloff_m.unwrap_or(0.0),
            anisotropy: fog.anisotropy,
        })
    }
}
