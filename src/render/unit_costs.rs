//! Unit costs of the cost model: nanoseconds of wall time.
//!
//! The costs of a kind of adapter are constants, so that all machines of a kind decide alike. Those of software
//! adapters are fitted to the passes of seven scenes on llvmpipe with two cores. Those of GPUs come from an
//! experiment on one data-center GPU, whose rasterizer is weak relative to its compute units; no scene has been
//! measured on a GPU yet.

use serde::{Deserialize, Serialize};

/// Nanoseconds that each unit of work takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnitCosts {
    /// Drawing a triangle.
    pub raster_triangle: f64,
    /// Drawing a pixel of the picture.
    pub raster_pixel: f64,
    /// Drawing a triangle into a shadow map.
    pub map_triangle: f64,
    /// Drawing a pixel of a shadow map.
    pub map_pixel: f64,
    /// Filtering a shadow map at a pixel.
    pub filter: f64,
    /// Tracing a primary ray, without its nodes.
    pub primary_ray: f64,
    /// Visiting a node with a primary ray.
    pub primary_node: f64,
    /// Tracing a shadow ray, without its nodes.
    pub shadow_ray: f64,
    /// Visiting a node with a shadow ray.
    pub shadow_node: f64,
    /// Tracing a mirror ray, without its nodes, and shading its hit.
    pub mirror_ray: f64,
    /// Visiting a node with a mirror ray: more than for primary rays, as neighboring rays diverge.
    pub mirror_node: f64,
    /// Marching a ray, without the part below.
    pub march_ray: f64,
    /// Part of marching a ray that grows with the nodes that the ray would visit if it were traced: the more there
    /// are, the farther apart the memory accesses of the march.
    pub march_node: f64,
    /// Building the pyramid, per pixel of the picture.
    pub pyramid_pixel: f64,
    /// Shading a screen hit.
    pub hit: f64,
    /// Starting a pass.
    pub pass: f64,
}

impl UnitCosts {
    /// Costs of software adapters.
    pub const PROCESSOR: Self = Self {
        raster_triangle: 90.0,
        raster_pixel: 24.0,
        map_triangle: 126.0,
        map_pixel: 10.0,
        filter: 40.0,
        primary_ray: 20.0,
        primary_node: 21.0,
        shadow_ray: 30.0,
        shadow_node: 30.0,
        mirror_ray: 160.0,
        mirror_node: 38.0,
        march_ray: 60.0,
        march_node: 14.0,
        pyramid_pixel: 4.3,
        hit: 220.0,
        pass: 150_000.0,
    };
    /// Costs of all other adapters.
    pub const GPU: Self = Self {
        raster_triangle: 2.2,
        raster_pixel: 0.5,
        map_triangle: 2.2,
        map_pixel: 0.05,
        filter: 0.05,
        primary_ray: 0.1,
        primary_node: 0.017,
        shadow_ray: 0.1,
        shadow_node: 0.02,
        mirror_ray: 0.2,
        mirror_node: 0.025,
        march_ray: 0.15,
        march_node: 0.005,
        pyramid_pixel: 0.02,
        hit: 0.1,
        pass: 10_000.0,
    };

    /// Costs of a kind of adapter.
    pub fn of_kind(software: bool) -> Self {
        if software { Self::PROCESSOR } else { Self::GPU }
    }
}
