//! The cost model: what a frame is expected to take by each way of rendering it, from counts of a
//! view and unit costs of a kind of adapter.
//!
//! Unit costs are nanoseconds of wall time and constants, so that all machines of a kind decide alike.
//! Those of software adapters are fitted to the passes of seven scenes on llvmpipe with two cores.
//! Those of GPUs come from an experiment on one data-center GPU, whose rasterizer is weak beside its
//! compute units; no scene has been measured on one yet.

use std::fmt;

use crate::scene::desc::LightKind;

use super::view_sample::ViewSample;

/// Nanoseconds that each piece of work takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitCosts {
    /// Drawing a triangle, and a pixel that the picture has.
    raster: (f64, f64),
    /// Drawing a triangle into one shadow map, and a pixel of the map.
    map: (f64, f64),
    /// Filtering a shadow map at a pixel.
    filter: f64,
    /// A primary ray, and a node that it visits.
    primary: (f64, f64),
    /// A shadow ray, and a node that it visits.
    shadow: (f64, f64),
    /// A mirror ray with the shading of what it meets, and a node that it visits, which costs more than
    /// of primary rays: neighbors go apart.
    mirror: (f64, f64),
    /// A ray of the march, and a node that it would visit if it were traced: the more there are, the
    /// further apart is what the march reads.
    march: (f64, f64),
    /// Building the pyramid, a pixel of the picture.
    pyramid: f64,
    /// Shading a hit of the march.
    hit: f64,
    /// Starting a pass.
    pass: f64,
}

impl UnitCosts {
    /// Of software adapters.
    pub const PROCESSOR: Self = Self {
        raster: (90.0, 24.0),
        map: (126.0, 10.0),
        filter: 40.0,
        primary: (20.0, 21.0),
        shadow: (30.0, 30.0),
        mirror: (160.0, 38.0),
        march: (60.0, 14.0),
        pyramid: 4.3,
        hit: 220.0,
        pass: 150_000.0,
    };
    /// Of all others.
    pub const GPU: Self = Self {
        raster: (2.2, 0.5),
        map: (2.2, 0.05),
        filter: 0.05,
        primary: (0.1, 0.017),
        shadow: (0.1, 0.02),
        mirror: (0.2, 0.025),
        march: (0.15, 0.005),
        pyramid: 0.02,
        hit: 0.1,
        pass: 10_000.0,
    };
}

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
    fn weight(&self) -> f64 {
        self.pixels * self.samples / f64::from(self.view.rays.max(1))
    }

    /// Visibility.
    pub fn visibility(&self, unit: &UnitCosts) -> Pair {
        let (triangle, pixel) = unit.raster;
        let raster = self.samples * (self.triangles_in_view * triangle + self.pixels * pixel);
        let (ray, node) = unit.primary;
        let counts = f64::from(self.view.rays) * ray + f64::from(self.view.visits) * node;
        let rays = self.weight() * counts + self.samples * unit.pass;
        Pair([("rays", MS * rays), ("raster", MS * raster)])
    }

    /// Shadows of a kind of light, as if every picture drew all maps. Hits of mirror rays are lit too.
    pub fn shadow(&self, unit: &UnitCosts, kind: usize) -> Pair {
        let view = &self.view;
        let (rays, visits) = view.shadows[kind];
        let lit = 1.0 + f64::from(view.reflective) / f64::from(view.surfaces.max(1));
        let (triangle, pixel) = unit.map;
        let draw = self.triangles * self.map_views[kind] * triangle;
        let maps = draw + self.map_pixels[kind] * pixel;
        let filter = self.weight() * lit * f64::from(rays) * unit.filter;
        let (ray, node) = unit.shadow;
        let counts = f64::from(rays) * ray + f64::from(visits) * node;
        let rays = self.weight() * lit * counts;
        Pair([("ray", MS * rays), ("map", MS * (maps + filter))])
    }

    /// Reflections.
    pub fn reflections(&self, unit: &UnitCosts) -> Pair {
        let view = &self.view;
        let of = |rays: u32, visits: u32| {
            let (ray, node) = unit.mirror;
            f64::from(rays) * ray + f64::from(visits) * node
        };
        let (ray, node) = unit.march;
        let march = f64::from(view.reflective) * ray + f64::from(view.mirror_visits) * node;
        let all = of(view.reflective, view.mirror_visits);
        let hidden = of(view.reflective - view.shown, view.refused_visits);
        let refused = hidden + (all - hidden) * (1.0 - ACCEPTED);
        let shown = f64::from(view.shown) * ACCEPTED * unit.hit;
        let fixed = self.samples * (self.pixels * unit.pyramid + 4.0 * unit.pass);
        let hybrid = self.weight() * (march + refused * APART + shown) + fixed;
        Pair([("hybrid", MS * hybrid), ("rt", MS * self.weight() * all)])
    }
}
