//! Resources that all passes are bound to.

use super::{ray_list::RayList, targets::Targets};
use crate::{
    buffers::frame_uniforms::FrameUniforms,
    maps::{
        box_faces::BoxFaces, far_maps::FarMaps, probe_maps::ProbeMaps, shadow_maps::ShadowMaps,
    },
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
    /// Cube maps of probes, in frames that look reflections up in them.
    pub probe_maps: Option<&'a ProbeMaps>,
    /// Maps of far things, in frames of method `near-far`.
    pub far_maps: Option<&'a FarMaps>,
    /// Faces of the box, in frames of method `ssr+box`.
    pub box_faces: Option<&'a BoxFaces>,
}
