//! Sampled rays of a view, traced on the CPU: the counts that the cost model needs. They depend on the scene alone,
//! so that all machines count alike.

use std::{collections::BTreeMap, ops::AddAssign};

use glam::DVec2;
use rayon::prelude::*;

use reflet_world::{
    Light, World,
    bvh::{Ray, SHADOWLESS, Trees},
};

use super::view_rays::{SurfacePoint, ViewRays, off_surface, places, towards};
use crate::{
    plan::may_reflect,
    settings::{options::RenderOptions, view::View},
};

/// Number of rays, and of the nodes that they visit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rays {
    /// Number of rays.
    pub rays: u32,
    /// Number of nodes.
    pub visits: u32,
}

impl Rays {
    fn one(visits: u32) -> Self {
        Self { rays: 1, visits }
    }
}

impl AddAssign for Rays {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.visits += other.visits;
    }
}

/// Counts summed over the samples of a view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewSample {
    /// Primary rays.
    pub primary: Rays,
    /// Number of primary rays that hit a surface.
    pub surfaces: u32,
    /// Number of surfaces among them that reflect.
    pub reflecting: u32,
    /// Shadow rays to each undecided light, by its index.
    pub shadows: BTreeMap<usize, Rays>,
}

impl ViewSample {
    /// Traces the rays of a view; cut-outs count as solid, and transmission is not followed.
    pub fn new(world: &World, trees: &Trees, view: &View, options: &RenderOptions) -> Self {
        let sampler = Sampler {
            rays: ViewRays { world, trees, view },
            cutoff: options.reflection.reflects_below(),
            undecided_lights: options.undecided_lights(world).collect(),
        };
        let samples = places().map(|place| sampler.sample(place));
        samples.reduce(Self::default, Self::plus)
    }

    fn plus(mut self, other: Self) -> Self {
        self.primary += other.primary;
        self.surfaces += other.surfaces;
        self.reflecting += other.reflecting;
        for (light, rays) in other.shadows {
            *self.shadows.entry(light).or_default() += rays;
        }
        self
    }
}

struct Sampler<'a> {
    rays: ViewRays<'a>,
    cutoff: f32,
    undecided_lights: Vec<(usize, &'a Light)>,
}

impl Sampler<'_> {
    /// Counts of one sample, at a point of the picture from 0 to 1 from its upper left corner.
    fn sample(&self, place: DVec2) -> ViewSample {
        let primary = self.rays.primary(place);
        let (hit, visits) = self.rays.trees.nearest_counted(&primary);
        let mut sum = ViewSample {
            primary: Rays::one(visits),
            ..ViewSample::default()
        };
        let Some(hit) = hit else { return sum };
        sum.surfaces = 1;
        let direction = primary.direction.normalize();
        let point = self.rays.point(&hit, direction);
        sum.shadows = self.shadows(&point);
        let material = self.rays.world.instances[point.instance].material;
        sum.reflecting = may_reflect(self.rays.world, material, self.cutoff).into();
        sum
    }

    /// The shadow rays from a point to the lights that may shine on it.
    fn shadows(&self, point: &SurfacePoint) -> BTreeMap<usize, Rays> {
        let lights = self.undecided_lights.iter();
        let counted = lights.filter_map(|(index, light)| {
            let (direction, t_max) = towards(light, point)?;
            let ray = Ray {
                direction,
                t_max,
                passes: SHADOWLESS,
                ..off_surface(point, direction)
            };
            let faces = direction.dot(point.normal) > 0.0;
            faces.then(|| (*index, Rays::one(self.rays.trees.any_counted(&ray).1)))
        });
        counted.collect()
    }
}
