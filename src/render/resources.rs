//! Everything that passes are bound to.

use super::{
    frame_uniforms::FrameUniforms, ray_list::RayList, scene::GpuScene, shadow_maps::ShadowMaps,
    targets::Targets,
};

/// What passes are bound to.
#[derive(Clone, Copy)]
pub struct Resources<'a> {
    /// Group 1.
    pub scene: &'a GpuScene,
    /// Of group 0.
    pub maps: &'a ShadowMaps,
    /// Of group 0.
    pub uniforms: &'a FrameUniforms,
    /// Intermediate textures.
    pub targets: &'a Targets,
    /// The lists of the frame.
    pub ray_list: &'a RayList,
}
