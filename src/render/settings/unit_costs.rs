//! Unit costs of the cost model, nanoseconds, each class of adapters with its source.
//!
//! The costs of a kind of adapter are constants, so that all machines of a kind decide alike. `docs/costs.md` lists
//! their sources and their gaps. Costs of software adapters are
//! processor time of all threads, costs of GPUs time on the device: only their ratios decide.

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
    /// Building the trees, per stored triangle; on the processor, for all adapters.
    pub tree_triangle: f64,
    /// Building the trees, per instance; on the processor, for all adapters.
    pub tree_instance: f64,
}

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
        primary_ray: 0.1,
        primary_node: 47.0,
        shadow_ray: 12.8,
        shadow_node: 75.0,
        mirror_ray: 109.0,
        mirror_node: 69.0,
        march_ray: 256.0,
        march_node: 10.2,
        pyramid_pixel: 8.6,
        hit: 251.0,
        pass: 160_000.0,
        tree_triangle: 970.0,
        tree_instance: 2_000.0,
    };
    /// Costs of GPUs: single passes of eight views on one data-center GPU (NVIDIA H100), whose rasterizer is weak
    /// relative to its compute units. There a pass of few rays takes as long as its longest ones, so that a node of a
    /// mirror ray costs .05 to .19 ns. Costs of triangles, of maps and of a pass are from an experiment with 2.6 million
    /// triangles on an NVIDIA H200.
    pub const GPU: Self = Self {
        raster_triangle: 2.2,
        raster_pixel: 0.5,
        map_triangle: 2.2,
        map_pixel: 0.05,
        map_capsule: 0.1,
        filter: 0.02,
        primary_ray: 0.03,
        primary_node: 0.024,
        shadow_ray: 0.01,
        shadow_node: 0.022,
        mirror_ray: 0.1,
        mirror_node: 0.08,
        march_ray: 0.35,
        march_node: 0.008,
        pyramid_pixel: 0.005,
        hit: 0.2,
        pass: 10_000.0,
        tree_triangle: Self::PROCESSOR.tree_triangle,
        tree_instance: Self::PROCESSOR.tree_instance,
    };
    /// Costs of a kind of adapter.
    pub fn of_kind(software: bool) -> Self {
        if software { Self::PROCESSOR } else { Self::GPU }
    }
}
