//! Data beside the targets that one pass of a frame leaves for another.

use reflet_scene::{desc::Method, words};

use crate::plan::Plan;

words! {
    /// Data that passes share through buffers and shadow maps.
    pub enum SharedData {
        /// Depth seen from lights.
        ShadowMaps = "shadow_maps",
        /// Depth of surfaces that the camera culls but reflection rays meet, found by primary rays.
        CulledDepth = "culled_depth",
        /// Lists of reflective pixels, screen hits, rays to trace and transmissive pixels.
        PixelLists = "pixel_lists",
        /// Lengths of the lists, and counts for the statistics.
        Counters = "counters",
        /// Workgroup counts of the passes over lists.
        DispatchSizes = "dispatch_sizes",
        /// The nearest depth of pixels and of ever larger cells of them.
        DepthPyramid = "depth_pyramid",
        /// Maps of the frame's method.
        MethodMaps = "method_maps",
    }
}

impl SharedData {
    /// Name in the output of `info --frame`, in frames with this plan.
    pub fn name_in(self, plan: &Plan) -> &'static str {
        let maps = plan.maps.and_then(Method::maps);
        let maps = maps.filter(|_| self == Self::MethodMaps);
        maps.unwrap_or(self.name())
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
