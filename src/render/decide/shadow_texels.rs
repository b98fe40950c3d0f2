//! Size of shadow map texels on the surfaces that a camera sees.

use glam::Vec3;
use rayon::prelude::*;

use reflet_base::math::Bounds;
use reflet_world::{Light, World, bvh::Trees};

use super::view_rays::{ViewRays, places};
use crate::{lighting::lights::map_texel_m, settings::view::View};

/// Number of pixels that a shadow map texel may span before shadows of small things are visibly lost.
pub const COARSE_PX: f32 = 16.0;

/// Sampled surfaces that a camera sees, and the bounds of the shadow casters.
#[derive(Debug)]
pub struct SeenSurfaces {
    /// Points on surfaces, and the width of a pixel there, meters.
    seen: Vec<(Vec3, f32)>,
    casters: Bounds,
}

impl SeenSurfaces {
    /// Traces rays of a view through a grid of pixels.
    pub fn new(world: &World, trees: &Trees, view: &View) -> Self {
        let rays = ViewRays { world, trees, view };
        let seen = places().filter_map(|place| {
            let ray = rays.primary(place);
            let hit = trees.nearest_counted(&ray).0?;
            let point = rays.point(&hit, ray.direction).position.as_vec3();
            Some((point, view.pixel_m() + hit.t as f32 * view.pixel_spread()))
        });
        let casters = world.instances.iter().filter(|i| !i.is_hidden());
        Self {
            seen: seen.collect(),
            casters: casters.fold(Bounds::EMPTY, |all, i| all.union(world.bounds_of(i))),
        }
    }

    /// Number of pixels that a texel of a light's shadow map spans, if the map is `px` wide: the median over the
    /// sampled surfaces; `None` where there are none.
    pub fn texel_px(&self, light: &Light, px: u32) -> Option<f32> {
        let kind = &light.desc.kind;
        let span =
            |(point, pixel_m): &(Vec3, f32)| map_texel_m(kind, px, &self.casters, *point) / pixel_m;
        let mut spans: Vec<f32> = self.seen.iter().map(span).collect();
        spans.sort_by(f32::total_cmp);
        spans.get(spans.len() / 2).copied()
    }
}
