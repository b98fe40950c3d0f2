//! Surfaces along rays of a view, and points that are spread over surfaces.

use std::f64::consts::PI;

use glam::DVec2;

use crate::decide::view_rays::{SurfacePoint, ViewRays};
use reflet_base::math::in_f64;
use reflet_world::bvh::{Ray, RayHit};

/// Largest number of surfaces that a ray passes.
const MOST_PASSED: usize = 64;
/// Their multiples, less their whole parts, are spread evenly over a square (Roberts 2018).
const SPREAD: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// Surfaces along a ray, whatever they hide; cut-outs count as solid.
pub fn all_along(rays: &ViewRays<'_>, ray: Ray) -> impl Iterator<Item = RayHit> {
    let next = move |t_min: f64| rays.trees.nearest(&Ray { t_min, ..ray }, |_, _, _| true);
    let all = std::iter::successors(next(ray.t_min), move |hit| next(hit.t));
    all.take(MOST_PASSED)
}

/// Surfaces along a ray, up to the first that lets no light through.
pub fn along(rays: &ViewRays<'_>, ray: Ray) -> impl Iterator<Item = RayHit> {
    let mut is_hidden = false;
    all_along(rays, ray).take_while(move |hit| {
        let shown = !is_hidden;
        is_hidden |= !passes_light(rays, hit);
        shown
    })
}

/// Whether the surface of a hit may let light through.
pub fn passes_light(rays: &ViewRays<'_>, hit: &RayHit) -> bool {
    let instance = &rays.world.instances[hit.instance as usize];
    rays.world.materials[instance.material].passes_light()
}

/// Number `index` of a sequence of points that is spread evenly over the unit square.
pub fn spread(index: usize) -> DVec2 {
    DVec2::from_array(SPREAD.map(|step| ((index as f64 + 0.5) * step).fract()))
}

/// So many points, spread by area over the surfaces of instances, each with the normal of its front.
pub fn points(rays: &ViewRays<'_>, instances: &[usize], count: usize) -> Vec<SurfacePoint> {
    let world = rays.world;
    let mut areas = Vec::new();
    let mut total = 0.0;
    for index in instances {
        let instance = &world.instances[*index];
        let mesh = &world.meshes[instance.mesh];
        let posed = world.posed(instance.mesh);
        let to_world = in_f64(&instance.world_from_object);
        for (number, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = posed
                .corners(*triangle)
                .map(|p| to_world.transform_point3(p.as_dvec3()));
            total += match mesh.placed_radius_m(&instance.world_from_object) {
                Some(radius_m) => f64::from(radius_m) * (f64::from(radius_m) * 2.0 + a.distance(b)),
                None => (b - a).cross(c - a).length() * 0.5,
            };
            areas.push((total, *index, number as u32));
        }
    }
    let point = |k: usize| {
        let (share, bary) = ((k as f64 + 0.5) / count as f64, spread(k));
        let at = areas.partition_point(|(until, ..)| *until < share * total);
        let (_, instance, triangle) = *areas.get(at)?;
        Some(point_of(rays, instance, triangle, bary))
    };
    (0..count).filter_map(point).collect()
}

/// Point of a triangle or a capsule of an instance, at a place of the unit square, with the normal of its front.
pub fn point_of(rays: &ViewRays<'_>, instance: usize, triangle: u32, place: DVec2) -> SurfacePoint {
    let world = rays.world;
    let is_round = world.meshes[world.instances[instance].mesh]
        .capsule_radius_m
        .is_some();
    let bary = match is_round {
        // The meridian of a sphere, evenly by area.
        true => DVec2::new((1.0 - 2.0 * place.x).acos() / PI, place.y),
        false if place.element_sum() > 1.0 => 1.0 - place,
        false => place,
    };
    let hit = RayHit {
        t: 0.0,
        instance: instance as u32,
        triangle,
        bary,
    };
    rays.point(&hit, -rays.front(&hit))
}
