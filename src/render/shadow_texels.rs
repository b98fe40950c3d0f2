//! How coarse shadow maps are for what a camera sees.

use glam::Vec3;
use rayon::prelude::*;

use crate::{
    math::Bounds,
    world::{Light, World, bvh::Trees},
};

use super::{
    lights::map_texel_m,
    view::View,
    view_rays::{ViewRays, places},
};

/// Pixels of the picture that a texel may span before shadows of small things are visibly lost.
pub const COARSE_PX: f32 = 16.0;

/// Surfaces that a camera sees, sampled, and what casts shadows on them.
#[derive(Debug)]
pub struct SeenSurfaces {
    /// Points, and how wide a pixel is there, meters.
    seen: Vec<(Vec3, f32)>,
    casters: Bounds,
}

impl SeenSurfaces {
    /// Follows rays of a view through a grid.
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

    /// Pixels that a texel of a light's shadow map spans, if it is `px` wide: the median over what is
    /// seen; `None` where nothing is.
    pub fn texel_px(&self, light: &Light, px: u32) -> Option<f32> {
        let kind = &light.desc.kind;
        let span =
            |(point, pixel_m): &(Vec3, f32)| map_texel_m(kind, px, &self.casters, *point) / pixel_m;
        let mut spans: Vec<f32> = self.seen.iter().map(span).collect();
        spans.sort_by(f32::total_cmp);
        spans.get(spans.len() / 2).copied()
    }
}
