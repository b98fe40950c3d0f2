//! Resources that all passes are bound to.

use std::any::Any;

use super::{ray_list::RayList, targets::Targets};
use crate::{
    buffers::frame_uniforms::FrameUniforms,
    maps::{method_maps::MethodMaps, shadow_maps::ShadowMaps},
    upload::scene::GpuScene,
};

/// Resources that passes are bound to.
#[derive(Clone, Copy)]
pub struct Resources<'a> {
    /// Scene data, bound as group 1.
    pub scene: &'a GpuScene,
    /// Shadow maps, bound as part of group 0.
    pub maps: &'a ShadowMaps,
    /// Uniform buffers, bound as part of group 0.
    pub uniforms: &'a FrameUniforms,
    /// Intermediate textures.
    pub targets: &'a Targets,
    /// Lists of the frame, in one buffer.
    pub ray_list: &'a RayList,
    /// Maps that the frame's method captures, if it has some.
    pub captured: Option<&'a dyn MethodMaps>,
}

impl<'a> Resources<'a> {
    /// The captured maps of a method; `None` in frames of others.
    pub fn maps<M: MethodMaps>(&self) -> Option<&'a M> {
        let maps: &dyn Any = self.captured?;
        maps.downcast_ref()
    }
}
