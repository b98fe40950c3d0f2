//! The cost model: expected time of a frame by each way of rendering it, from counts of a view and the unit costs of
//! a kind of adapter.

use std::fmt;

use super::map_work::MapWork;
use super::view_sample::{MirrorRays, ViewSample};
use crate::settings::unit_costs::UnitCosts;

/// Size of the frame and of the scene, and counts of the view.
#[derive(Clone, Debug, PartialEq)]
pub struct Workload {
    /// Number of pixels of the picture.
    pub pixels: f64,
    /// Number of sub-frames.
    pub samples: f64,
    /// Work of drawing what the camera sees, in triangles of a fine mesh.
    pub triangles_in_view: f64,
    /// Counts of the view.
    pub view: ViewSample,
}

/// Two ways of rendering by name, with their expected milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair([(&'static str, f64); 2]);

impl Pair {
    /// Name of the cheaper way; of the second, if both cost the same.
    pub fn cheaper(&self) -> &'static str {
        let [first, second] = self.0;
        if first.1 < second.1 {
            first.0
        } else {
            second.0
        }
    }

    /// Expected milliseconds of both ways.
    pub fn ms(&self) -> [f64; 2] {
        self.0.map(|(_, ms)| ms)
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

/// Expected share of the mirror rays with a visible hit that the march verifies: measured 46 % to 100 % over several
/// scenes.
const ACCEPTED: f64 = 0.7;
/// Factor on the cost of the few rays that the march refuses, as they are less coherent.
const APART: f64 = 1.3;

const MS: f64 = 1e-6; // in a nanosecond

impl Workload {
    /// Number of pixels of the picture, over all sub-frames, that one sampled ray stands for.
    pub fn weight(&self) -> f64 {
        self.pixels * self.samples / f64::from(self.view.rays.max(1))
    }

    /// Expected costs of visibility by rays and by rasterization.
    pub fn visibility(&self, unit: &UnitCosts) -> Pair {
        let triangles = self.triangles_in_view * unit.raster_triangle;
        let raster = self.samples * (triangles + self.pixels * unit.raster_pixel);
        let counts = f64::from(self.view.rays) * unit.primary_ray
            + f64::from(self.view.visits) * unit.primary_node;
        let rays = self.weight() * counts + self.samples * unit.pass;
        Pair([("rays", MS * rays), ("raster", MS * raster)])
    }

    /// Expected costs of the shadows of lights with these maps, as if every picture drew all maps. Hits of mirror rays
    /// are lit too.
    pub fn shadow<'a>(
        &self,
        unit: &UnitCosts,
        maps: impl IntoIterator<Item = &'a MapWork>,
    ) -> Pair {
        let view = &self.view;
        let lit = 1.0 + f64::from(view.mirror.rays) / f64::from(view.surfaces.max(1));
        let of_pixels = self.weight() * lit;
        let (mut by_rays, mut by_maps) = (0.0, 0.0);
        for map in maps {
            let (rays, visits) = view.shadows.get(&map.light).copied().unwrap_or_default();
            let counts = f64::from(rays) * unit.shadow_ray + f64::from(visits) * unit.shadow_node;
            by_rays += of_pixels * counts;
            by_maps += map.draw_ns(unit) + of_pixels * f64::from(rays) * unit.filter;
        }
        Pair([("ray", MS * by_rays), ("map", MS * by_maps)])
    }

    /// Expected costs of the mirror rays of pixels by `hybrid` and `rt`. Rays onward from the hits and towards lights are
    /// left out: they are the same for both methods.
    pub fn reflections(&self, unit: &UnitCosts) -> Pair {
        let mirror = &self.view.mirror;
        let fixed = self.samples * (self.pixels * unit.pyramid_pixel + 4.0 * unit.pass);
        let hybrid = self.weight() * mirror.marched(unit) + fixed;
        let rt = self.weight() * mirror.traced(unit);
        Pair([("hybrid", MS * hybrid), ("rt", MS * rt)])
    }
}

impl MirrorRays {
    /// Expected time to trace them all, nanoseconds.
    fn traced(&self, unit: &UnitCosts) -> f64 {
        f64::from(self.rays) * unit.mirror_ray + f64::from(self.visits) * unit.mirror_node
    }

    /// Expected time to march them, to shade the hits that the picture shows and to trace the others, nanoseconds.
    fn marched(&self, unit: &UnitCosts) -> f64 {
        let march =
            f64::from(self.rays) * unit.march_ray + f64::from(self.visits) * unit.march_node;
        let hidden = Self {
            rays: self.rays - self.shown,
            visits: self.refused_visits,
            ..Self::default()
        };
        let hidden = hidden.traced(unit);
        let refused = hidden + (self.traced(unit) - hidden) * (1.0 - ACCEPTED);
        march + refused * APART + f64::from(self.shown) * ACCEPTED * unit.hit
    }
}
