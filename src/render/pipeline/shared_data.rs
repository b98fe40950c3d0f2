//! Data beside the targets that one pass of a frame leaves for another.

use reflet_scene::desc::Method;

use crate::plan::Plan;

/// Data that passes share through buffers and shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SharedData {
    /// Depth seen from lights.
    ShadowMaps,
    /// Depth of surfaces that the camera culls but reflection rays meet, found by primary rays.
    CulledDepth,
    /// Lists of reflective pixels, screen hits, rays to trace and transmissive pixels.
    PixelLists,
    /// Lengths of the lists, and counts for the statistics.
    Counters,
    /// Workgroup counts of the passes over lists.
    DispatchSizes,
    /// The nearest depth of pixels and of ever larger cells of them.
    DepthPyramid,
    /// Maps of the frame's method.
    MethodMaps,
}

impl SharedData {
    /// Name in the output of `info --frame`, in frames with this plan.
    pub fn name(self, plan: &Plan) -> &'static str {
        match self {
            Self::ShadowMaps => "shadow_maps",
            Self::CulledDepth => "culled_depth",
            Self::PixelLists => "pixel_lists",
            Self::Counters => "counters",
            Self::DispatchSizes => "dispatch_sizes",
            Self::DepthPyramid => "depth_pyramid",
            Self::MethodMaps => plan.maps.and_then(Method::maps).unwrap_or("method_maps"),
        }
    }

    /// Whether frames with this plan have the data, where a pass that writes it is recorded.
    pub const fn is_used(self, plan: &Plan) -> bool {
        let features = &plan.features;
        match self {
            Self::ShadowMaps => features.cube_maps || features.flat_maps,
            Self::CulledDepth => features.culled_surfaces,
            Self::PixelLists | Self::DispatchSizes => features.lists,
            Self::Counters => features.lists || features.traced,
            Self::DepthPyramid => true,
            Self::MethodMaps => plan.maps.is_some(),
        }
    }
}
