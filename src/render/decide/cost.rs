//! The cost model: expected milliseconds of two ways of rendering a frame, from counts of a view and the unit costs of
//! a kind of adapter.

use reflet_world::{World, bvh::Trees};

use super::{
    map_work::MapWork, triangles_in_view, unit_costs::UnitCosts, view_of, view_sample::ViewSample,
};
use crate::settings::options::RenderOptions;

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

const MS: f64 = 1e-6; // in a nanosecond

impl Workload {
    /// Counts of a world as the options' camera sees it.
    pub fn new(world: &World, trees: &Trees, options: &RenderOptions) -> Self {
        let [width, height] = options.image.size.map(f64::from);
        Self {
            pixels: width * height,
            samples: f64::from(options.image.samples.count()),
            triangles_in_view: triangles_in_view(world, options),
            view: ViewSample::new(world, trees, &view_of(world, options), options),
        }
    }

    /// Number of pixels of the picture, over all sub-frames, that one sampled ray stands for.
    pub fn weight(&self) -> f64 {
        self.pixels * self.samples / f64::from(self.view.primary.rays.max(1))
    }

    /// Visibility by rays and by rasterization.
    pub fn visibility(&self, unit: &UnitCosts) -> [f64; 2] {
        let triangles = self.triangles_in_view * unit.raster_triangle;
        let raster = self.samples * (triangles + self.pixels * unit.raster_pixel);
        let rays = self.weight() * unit.primary.of(self.view.primary) + self.samples * unit.pass;
        [MS * rays, MS * raster]
    }

    /// Shadows of lights by rays and by these maps, as if every picture drew all maps. Hits of mirror rays are lit too.
    pub fn shadow<'a>(
        &self,
        unit: &UnitCosts,
        maps: impl IntoIterator<Item = &'a MapWork>,
    ) -> [f64; 2] {
        let view = &self.view;
        let lit = 1.0 + f64::from(view.reflecting) / f64::from(view.surfaces.max(1));
        let of_pixels = self.weight() * lit;
        let (mut by_rays, mut by_maps) = (0.0, 0.0);
        for map in maps {
            let counted = view.shadows.get(&map.light).copied().unwrap_or_default();
            by_rays += of_pixels * unit.shadow.of(counted);
            by_maps += map.draw_ns(unit) + of_pixels * f64::from(counted.rays) * unit.filter;
        }
        [MS * by_rays, MS * by_maps]
    }
}
