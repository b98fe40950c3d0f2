//! Unit costs of the cost model, nanoseconds, each class of adapters with its source.
//!
//! The costs of a kind of adapter are constants, so that all machines of a kind decide alike. `docs/costs.md` lists
//! their sources and their gaps. Costs of software adapters are
//! processor time of all threads, costs of GPUs time on the device: only their ratios decide.

use super::view_sample::Rays;

/// Nanoseconds of a ray without its nodes, and of a node that it visits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCost(pub f64, pub f64);

impl RayCost {
    /// Expected time of counted rays.
    pub fn of(self, counted: Rays) -> f64 {
        f64::from(counted.rays) * self.0 + f64::from(counted.visits) * self.1
    }
}

/// Nanoseconds that each unit of work takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitCosts {
    /// Drawing a triangle.
    pub raster_triangle: f64,
    /// Drawing a pixel of the picture.
    pub raster_pixel: f64,
    /// Drawing a triangle into a shadow map.
    pub map_triangle: f64,
    /// Drawing a pixel of a shadow map.
    pub map_pixel: f64,
    /// Drawing a texel of a shadow map that a sphere or a capsule covers.
    pub map_capsule: f64,
    /// Filtering a shadow map at a pixel.
    pub filter: f64,
    /// Tracing a primary ray.
    pub primary: RayCost,
    /// Tracing a shadow ray.
    pub shadow: RayCost,
    /// Starting a pass.
    pub pass: f64,
}

/// Building the trees, per stored triangle; on the processor, for all adapters.
pub const TREE_TRIANGLE: f64 = 970.0;
/// Building the trees, per instance; likewise.
pub const TREE_INSTANCE: f64 = 2_000.0;

impl UnitCosts {
    /// Costs of software adapters: medians of three fits to timed frames on llvmpipe (Mesa 22.3.6, two cores of
    /// an AMD EPYC), in processor time. Costs of 0.1 are too small for the times to show.
    pub const PROCESSOR: Self = Self {
        raster_triangle: 153.0,
        raster_pixel: 5.4,
        map_triangle: 106.0,
        map_pixel: 2.0,
        map_capsule: 105.0,
        filter: 60.0,
        primary: RayCost(0.1, 47.0),
        shadow: RayCost(12.8, 75.0),
        pass: 160_000.0,
    };
    /// Costs of GPUs: single passes of eight views on one data-center GPU (NVIDIA H100), whose rasterizer is weak
    /// relative to its compute units. Costs of triangles, of maps and of a pass are from an experiment with 2.6 million
    /// triangles on an NVIDIA H200.
    pub const GPU: Self = Self {
        raster_triangle: 2.2,
        raster_pixel: 0.5,
        map_triangle: 2.2,
        map_pixel: 0.05,
        map_capsule: 0.1,
        filter: 0.02,
        primary: RayCost(0.03, 0.024),
        shadow: RayCost(0.01, 0.022),
        pass: 10_000.0,
    };

    /// Costs of a kind of adapter.
    pub fn of_kind(software: bool) -> Self {
        if software { Self::PROCESSOR } else { Self::GPU }
    }
}
