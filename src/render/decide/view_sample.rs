//! Sampled rays of a view, traced on the CPU: the counts that the cost model needs. They depend on the scene alone,
//! so that all machines count alike.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use reflet_world::{
    Light, World,
    bvh::{Ray, RayHit, SHADOWLESS, Trees},
};

use super::view_rays::{SurfacePoint, ViewRays, mirror_ray, off_surface, places, towards};
use crate::{
    plan::may_reflect,
    settings::{options::RenderOptions, view::View},
};

/// Maximum distance between a mirror ray's hit and the surface seen on the screen to count as the same place, as a
/// share of the depth.
const SAME_PLACE: f64 = 2e-3;

/// Counts of mirror rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MirrorRays {
    /// Number of primary hits on surfaces that reflect, each of which starts one.
    pub rays: u32,
    /// Number of nodes that they visit up to their first hit.
    pub visits: u32,
    /// Number of mirror rays whose hit the picture shows.
    pub shown: u32,
    /// Number of nodes that the other mirror rays visit.
    pub refused_visits: u32,
}

impl MirrorRays {
    fn plus(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            visits: self.visits + other.visits,
            shown: self.shown + other.shown,
            refused_visits: self.refused_visits + other.refused_visits,
        }
    }
}

/// Counts summed over the samples of a view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewSample {
    /// Number of primary rays.
    pub rays: u32,
    /// Number of nodes that primary rays visit.
    pub visits: u32,
    /// Number of primary rays that hit a surface.
    pub surfaces: u32,
    /// Mirror rays.
    pub mirror: MirrorRays,
    /// Number of shadow rays to each undecided light, by its index, and number of nodes that they visit.
    pub shadows: BTreeMap<usize, (u32, u32)>,
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
        for (light, (rays, visits)) in other.shadows {
            let sum = self.shadows.entry(light).or_default();
            *sum = (sum.0 + rays, sum.1 + visits);
        }
        Self {
            rays: self.rays + other.rays,
            visits: self.visits + other.visits,
            surfaces: self.surfaces + other.surfaces,
            mirror: self.mirror.plus(other.mirror),
            shadows: self.shadows,
        }
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
        let mut sum = ViewSample {
            rays: 1,
            ..ViewSample::default()
        };
        let (hit, visits) = self.rays.trees.nearest_counted(&self.rays.primary(place));
        sum.visits = visits;
        let Some(hit) = hit else { return sum };
        sum.surfaces = 1;
        let direction = self.rays.primary(place).direction.normalize();
        let point = self.rays.point(&hit, direction);
        self.count_shadows(&point, &mut sum);
        if !self.reflects(&point) {
            return sum;
        }
        let ray = mirror_ray(&point, direction);
        let (met, visits) = self.rays.trees.nearest_counted(&ray);
        let shown = met.is_some_and(|met| self.is_shown(&ray, &met));
        sum.mirror = MirrorRays {
            rays: 1,
            visits,
            shown: u32::from(shown),
            refused_visits: if shown { 0 } else { visits },
        };
        sum
    }

    fn reflects(&self, point: &SurfacePoint) -> bool {
        let material = self.rays.world.instances[point.instance].material;
        may_reflect(self.rays.world, material, self.cutoff)
    }

    /// Whether the picture shows the hit of a mirror ray, and the surface there does not reflect.
    fn is_shown(&self, ray: &Ray, hit: &RayHit) -> bool {
        let point = self.rays.point(hit, ray.direction);
        let Some(place) = self.place_of(point.position) else {
            return false;
        };
        let inside = place.cmpge(DVec2::ZERO).all() && place.cmplt(DVec2::ONE).all();
        if !inside || self.reflects(&point) {
            return false;
        }
        let primary = self.rays.primary(place);
        let (seen, _) = self.rays.trees.nearest_counted(&primary);
        let depth = (point.position - primary.origin).dot(self.rays.view.forward.as_dvec3());
        seen.is_some_and(|seen| (seen.t - depth).abs() < SAME_PLACE * depth)
    }

    /// Position of a point in the picture, 0 to 1 inside; `None` behind the near plane.
    fn place_of(&self, point: DVec3) -> Option<DVec2> {
        let (place, depth_m) = self.rays.view.place(point);
        let place = DVec2::new(place.x, -place.y) * 0.5 + 0.5;
        (depth_m > f64::from(self.rays.view.near_m)).then_some(place)
    }

    fn count_shadows(&self, point: &SurfacePoint, sum: &mut ViewSample) {
        for (index, light) in &self.undecided_lights {
            let Some((direction, t_max)) = towards(light, point) else {
                continue;
            };
            if direction.dot(point.normal) <= 0.0 {
                continue;
            }
            let ray = Ray {
                direction,
                t_max,
                passes: SHADOWLESS,
                ..off_surface(point, direction)
            };
            let (rays, visits) = sum.shadows.entry(*index).or_default();
            *rays += 1;
            *visits += self.rays.trees.any_counted(&ray).1;
        }
    }
}
