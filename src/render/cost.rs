//! The cost model: what a frame is expected to take by each way of rendering it, from counts of a
//! view and unit costs of a kind of adapter.

use std::fmt;

use crate::scene::desc::LightKind;

use super::{unit_costs::UnitCosts, view_sample::ViewSample};

/// What is drawn and how large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workload {
    /// Pixels of the picture.
    pub pixels: f64,
    /// Sub-frames.
    pub samples: f64,
    /// Triangles that the camera draws.
    pub triangles_in_view: f64,
    /// Triangles of the scene.
    pub triangles: f64,
    /// Pixels of the maps of the `auto` lights of each kind, if they had maps.
    pub map_pixels: [f64; LightKind::NAMES.len()],
    /// Views of those maps that a triangle is expected in.
    pub map_views: [f64; LightKind::NAMES.len()],
    /// Counts of the view.
    pub view: ViewSample,
}

/// Two ways by name, with milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair([(&'static str, f64); 2]);

impl Pair {
    /// The one that is expected to take less time; the second, if both take the same.
    pub fn cheaper(&self) -> &'static str {
        let [first, second] = self.0;
        if first.1 < second.1 {
            first.0
        } else {
            second.0
        }
    }
}

impl fmt::Display for Pair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = self.0;
        write!(
            f,
            "{} {:.2} ms, {} {:.2} ms expected",
            first.0, first.1, second.0, second.1
        )
    }
}

/// Of the mirror rays whose hit the picture shows, those that the march is expected to verify: 46 % to
/// 100 % in the scenes measured.
const ACCEPTED: f64 = 0.7;
/// What a ray costs more among the few that the march refuses, for they are less alike.
const APART: f64 = 1.3;

const MS: f64 = 1e-6; // in a nanosecond

impl Workload {
    /// Pixels of the picture that one sample stands for, over all sub-frames.
    pub fn weight(&self) -> f64 {
        self.pixels * self.samples / f64::from(self.view.rays.max(1))
    }

    /// Visibility.
    pub fn visibility(&self, unit: &UnitCosts) -> Pair {
        let triangles = self.triangles_in_view * unit.raster_triangle;
        let raster = self.samples * (triangles + self.pixels * unit.raster_pixel);
        let counts = f64::from(self.view.rays) * unit.primary_ray
            + f64::from(self.view.visits) * unit.primary_node;
        let rays = self.weight() * counts + self.samples * unit.pass;
        Pair([("rays", MS * rays), ("raster", MS * raster)])
    }

    /// Shadows of a kind of light, as if every picture drew all maps. Hits of mirror rays are lit too.
    pub fn shadow(&self, unit: &UnitCosts, kind: usize) -> Pair {
        let view = &self.view;
        let (rays, visits) = view.shadows[kind];
        let lit = 1.0 + f64::from(view.reflective) / f64::from(view.surfaces.max(1));
        let draw = self.triangles * self.map_views[kind] * unit.map_triangle;
        let maps = draw + self.map_pixels[kind] * unit.map_pixel;
        let filter = self.weight() * lit * f64::from(rays) * unit.filter;
        let counts = f64::from(rays) * unit.shadow_ray + f64::from(visits) * unit.shadow_node;
        let rays = self.weight() * lit * counts;
        Pair([("ray", MS * rays), ("map", MS * (maps + filter))])
    }

    /// Reflections.
    pub fn reflections(&self, unit: &UnitCosts) -> Pair {
        let view = &self.view;
        let of = |rays: u32, visits: u32| {
            f64::from(rays) * unit.mirror_ray + f64::from(visits) * unit.mirror_node
        };
        let march = f64::from(view.reflective) * unit.march_ray
            + f64::from(view.mirror_visits) * unit.march_node;
        let all = of(view.reflective, view.mirror_visits);
        let hidden = of(view.reflective - view.shown, view.refused_visits);
        let refused = hidden + (all - hidden) * (1.0 - ACCEPTED);
        let shown = f64::from(view.shown) * ACCEPTED * unit.hit;
        let fixed = self.samples * (self.pixels * unit.pyramid_pixel + 4.0 * unit.pass);
        let hybrid = self.weight() * (march + refused * APART + shown) + fixed;
        Pair([("hybrid", MS * hybrid), ("rt", MS * self.weight() * all)])
    }
}
