//! Sampled rays of a view, followed on the CPU: the counts that the cost model needs. They depend on
//! the scene alone, so that all machines count alike.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::{
    scene::desc::{LightKind, ShadowMode},
    world::{
        Light, World,
        bvh::{Ray, RayHit, Trees},
    },
};

use super::{plan::may_reflect, view::View};

/// Samples across and down the picture.
const GRID: [u32; 2] = [40, 24];
/// Most reflections in a row that are followed.
const MAX_BOUNCES: u32 = 4;
/// How far a surface seen on the screen may lie from the hit of a mirror ray to count as that hit,
/// of its distance.
const SAME_PLACE: f64 = 2e-3;

/// Sums over the samples of a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewSample {
    /// Primary rays.
    pub rays: u32,
    /// Nodes that they visit.
    pub visits: u32,
    /// Those that meet a surface.
    pub surfaces: u32,
    /// Surfaces that reflect.
    pub reflective: u32,
    /// Nodes that mirror rays visit, further bounces included.
    pub mirror_visits: u32,
    /// Mirror rays whose hit the picture shows.
    pub shown: u32,
    /// Nodes that the others visit.
    pub refused_visits: u32,
    /// Shadow rays to the `auto` lights of each kind, and the nodes that they visit.
    pub shadows: [(u32, u32); LightKind::NAMES.len()],
}

impl ViewSample {
    /// Follows the rays of a view; cut-outs count as solid, and further reflections are counted up to
    /// `bounces`.
    pub fn new(world: &World, trees: &Trees, view: &View, cutoff: f32, bounces: u32) -> Self {
        let sampler = Sampler {
            world,
            trees,
            view,
            cutoff,
            bounces: bounces.min(MAX_BOUNCES),
        };
        let count = GRID[0] * GRID[1];
        let samples = (0..count).into_par_iter().map(|i| {
            let place = glam::UVec2::new(i % GRID[0], i / GRID[0]).as_dvec2() + 0.5;
            sampler.sample(place / glam::UVec2::from(GRID).as_dvec2())
        });
        samples.reduce(Self::default, Self::plus)
    }

    fn plus(self, other: Self) -> Self {
        let shadows = std::array::from_fn(|kind| {
            let ((a, b), (c, d)) = (self.shadows[kind], other.shadows[kind]);
            (a + c, b + d)
        });
        Self {
            rays: self.rays + other.rays,
            visits: self.visits + other.visits,
            surfaces: self.surfaces + other.surfaces,
            reflective: self.reflective + other.reflective,
            mirror_visits: self.mirror_visits + other.mirror_visits,
            shown: self.shown + other.shown,
            refused_visits: self.refused_visits + other.refused_visits,
            shadows,
        }
    }
}

struct Sampler<'a> {
    world: &'a World,
    trees: &'a Trees,
    view: &'a View,
    cutoff: f32,
    bounces: u32,
}

/// A point of a surface.
struct Point {
    position: DVec3,
    normal: DVec3,
    reflects: bool,
}

impl Sampler<'_> {
    /// A place of the picture, 0 to 1 from its upper left corner.
    fn sample(&self, place: DVec2) -> ViewSample {
        let mut sum = ViewSample {
            rays: 1,
            ..ViewSample::default()
        };
        let (hit, visits) = self.trees.nearest_counted(&self.primary(place));
        sum.visits = visits;
        let Some(hit) = hit else { return sum };
        sum.surfaces = 1;
        let eye = self.view.eye.as_dvec3();
        let point = self.point(&hit, self.primary(place).direction);
        self.count_shadows(&point, &mut sum);
        if !point.reflects {
            return sum;
        }
        sum.reflective = 1;
        let ray = mirror_ray(&point, (point.position - eye).normalize());
        let (met, visits) = self.trees.nearest_counted(&ray);
        let mut all_visits = visits;
        let shown = met.is_some_and(|met| self.is_shown(&ray, &met));
        let (mut ray, mut met) = (ray, met);
        for _ in 1..self.bounces {
            let Some(hit) = met else { break };
            let next = self.point(&hit, ray.direction);
            if !next.reflects {
                break;
            }
            ray = mirror_ray(&next, ray.direction);
            let (hit, visits) = self.trees.nearest_counted(&ray);
            all_visits += visits;
            met = hit;
        }
        sum.mirror_visits = all_visits;
        if shown {
            sum.shown = 1;
        } else {
            sum.refused_visits = all_visits;
        }
        sum
    }

    fn primary(&self, place: DVec2) -> Ray {
        let ndc = place * 2.0 - 1.0;
        let view = self.view;
        Ray {
            origin: view.eye.as_dvec3(),
            direction: view.forward.as_dvec3() + view.right.as_dvec3() * ndc.x
                - view.up.as_dvec3() * ndc.y,
            t_min: f64::from(view.near_m),
            t_max: f64::INFINITY,
        }
    }

    fn point(&self, hit: &RayHit, direction: DVec3) -> Point {
        let instance = &self.world.instances[hit.instance as usize];
        let mesh = &self.world.meshes[instance.mesh];
        let corners = mesh.triangles[hit.triangle as usize].map(|i| i as usize);
        let weights = [1.0 - hit.bary.x - hit.bary.y, hit.bary.x, hit.bary.y].map(|w| w as f32);
        let mix = |of: &[Vec3]| -> Vec3 { (0..3).map(|k| of[corners[k]] * weights[k]).sum() };
        let to_world = instance.world_from_object;
        let normal = to_world.matrix3.inverse().transpose() * mix(&mesh.normals);
        let normal = normal.as_dvec3().normalize_or(-direction.normalize());
        let position = to_world.transform_point3(mix(&mesh.positions)).as_dvec3();
        Point {
            position,
            normal: if normal.dot(direction) > 0.0 {
                -normal
            } else {
                normal
            },
            reflects: may_reflect(self.world, instance.material, self.cutoff),
        }
    }

    /// Whether the picture shows the hit of a mirror ray, and does not reflect there.
    fn is_shown(&self, ray: &Ray, hit: &RayHit) -> bool {
        let point = self.point(hit, ray.direction);
        let Some(place) = self.place_of(point.position) else {
            return false;
        };
        let inside = place.cmpge(DVec2::ZERO).all() && place.cmplt(DVec2::ONE).all();
        if !inside || point.reflects {
            return false;
        }
        let primary = self.primary(place);
        let (seen, _) = self.trees.nearest_counted(&primary);
        let depth = (point.position - primary.origin).dot(self.view.forward.as_dvec3());
        seen.is_some_and(|seen| (seen.t - depth).abs() < SAME_PLACE * depth)
    }

    /// Where the picture shows a point, 0 to 1 inside; `None` behind the near plane.
    fn place_of(&self, point: DVec3) -> Option<DVec2> {
        let offset = point - self.view.eye.as_dvec3();
        let depth = offset.dot(self.view.forward.as_dvec3());
        let along = |axis: Vec3| {
            let axis = axis.as_dvec3();
            offset.dot(axis) / axis.length_squared() / depth
        };
        let ndc = DVec2::new(along(self.view.right), -along(self.view.up));
        (depth > f64::from(self.view.near_m)).then_some(ndc * 0.5 + 0.5)
    }

    fn count_shadows(&self, point: &Point, sum: &mut ViewSample) {
        let lights = self.world.lights.iter();
        for light in lights.filter(|l| l.desc.shadow == ShadowMode::Auto) {
            let kind = &light.desc.kind;
            let (direction, t_max) = match (kind.position(), kind.direction()) {
                (Some(position), _) => (position.as_dvec3() - point.position, 0.9999),
                (None, Some(direction)) => (-direction.as_dvec3(), f64::INFINITY),
                (None, None) => continue,
            };
            if direction.dot(point.normal) <= 0.0 || !is_in_reach(light, direction) {
                continue;
            }
            let ray = Ray {
                direction,
                t_max,
                ..off_surface(point, direction)
            };
            let (rays, visits) = &mut sum.shadows[kind.index()];
            *rays += 1;
            *visits += self.trees.any_counted(&ray).1;
        }
    }
}

/// Whether a light's cone and range reach a point; `to_light` leads from there to the light.
fn is_in_reach(light: &Light, to_light: DVec3) -> bool {
    let in_cone = match light.desc.kind {
        LightKind::Spot {
            direction,
            outer_deg,
            ..
        } => {
            let cosine = -to_light
                .normalize()
                .dot(direction.as_dvec3().normalize_or_zero());
            cosine > f64::from(outer_deg.to_radians().cos())
        }
        LightKind::Rect { direction, .. } | LightKind::Disk { direction, .. } => {
            direction.as_dvec3().dot(to_light) < 0.0
        }
        LightKind::Point { .. } | LightKind::Directional { .. } => true,
    };
    in_cone
        && light
            .range_m
            .is_none_or(|range_m| to_light.length() < f64::from(range_m))
}

fn mirror_ray(point: &Point, direction: DVec3) -> Ray {
    let mirrored = direction - point.normal * (2.0 * direction.dot(point.normal));
    off_surface(point, mirrored.normalize())
}

fn off_surface(point: &Point, direction: DVec3) -> Ray {
    let size = point.position.abs().max_element().max(1e-3);
    Ray {
        origin: point.position + point.normal * (size * 1e-4),
        direction,
        t_min: 0.0,
        t_max: f64::INFINITY,
    }
}
