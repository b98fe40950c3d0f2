//! Surfaces that lie in each other, so that rounding decides which of the two is seen.

use std::collections::BTreeMap;

use glam::DVec3;

use super::text::related;
use crate::{
    math::{Bounds, in_f64},
    render::decide::view_rays::ViewRays,
    scene::{diagnostic::Diagnostic, stages::Scene},
    world::{
        Instance, World,
        bvh::{Ray, RayHit, capsule::Capsule},
    },
};

/// Largest distance of two surfaces that count as one, as a share of the coordinates: some steps of a 32-bit float.
const NEAR: f64 = 1e-6;
/// Least cosine between the normals of two such surfaces.
const PARALLEL: f64 = 0.9999;
/// Largest number of triangles at a point that are compared with its surface.
const MOST_COMPARED: usize = 20_000;
/// Least number of rays that must meet two surfaces at once.
const FEWEST: usize = 4;

/// Warnings about pairs of instances of different materials whose surfaces coincide where these hits of a view are, and
/// about copies at one place.
pub fn lint(scene: &Scene, rays: &ViewRays, hits: &[Option<(Ray, RayHit)>]) -> Vec<Diagnostic> {
    let mut counts: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let bounds: Vec<_> = rays
        .world
        .instances
        .iter()
        .map(|i| rays.world.bounds_of(i))
        .collect();
    for (ray, hit) in hits.iter().flatten() {
        if let Some(second) = second(rays, &bounds, hit, ray.direction) {
            let first = hit.instance as usize;
            *counts
                .entry([first.min(second), first.max(second)])
                .or_default() += 1;
        }
    }
    let found = counts.into_iter().filter(|(_, count)| *count >= FEWEST);
    let found = found.map(|(pair, _)| {
        let [a, b] = pair.map(|i| rays.world.instances[i].name.as_str());
        let [first, second] = pair.map(|i| &rays.world.instances[i]);
        let seen = match first.material == second.material {
            true => "one hides the other, or glass counts twice",
            false => "spots of both show",
        };
        let message = format!("surfaces of \"{a}\" and \"{b}\" are in one place, so that {seen}");
        let copied = |name: &str| name.split_once('[').map(|(name, _)| name.to_owned());
        let help = match copied(a).is_some_and(|name| copied(b) == Some(name)) {
            true => "write a larger `step` in its `repeat`, the way from one copy to the next".to_owned(),
            false => format!(
                "remove \"{b}\", or move one of them by its `translation`: surfaces by 0.001 m, whole copies by their size"
            ),
        };
        let at = rays
            .world
            .place_of(scene, pair[1])
            .cloned()
            .unwrap_or_default();
        related(
            Diagnostic::new("same-place", at, message).help(help),
            scene,
            rays.world,
            pair[0],
        )
    });
    found.collect()
}

/// Another instance, of another material or a copy, whose surface is where a ray meets the surface of the first;
/// `bounds` has the bounds of all instances.
fn second(rays: &ViewRays, bounds: &[Bounds], hit: &RayHit, direction: DVec3) -> Option<usize> {
    let world = rays.world;
    let point = rays.point(hit, direction);
    let first = &world.instances[point.instance];
    let near = point.position.abs().max_element().max(1e-3) * NEAR;
    let normal = surface_at(world, first, hit.triangle, point.position)?.normal;
    let mut compared = 0;
    world
        .instances
        .iter()
        .enumerate()
        .position(|(index, other)| {
            let mesh = &world.meshes[other.mesh];
            let bounds = &bounds[index];
            let is_copy =
                other.mesh == first.mesh && other.world_from_object == first.world_from_object;
            let is_candidate = index != point.instance
                && (other.material != first.material || is_copy)
                && other.shown.visible
                && !mesh.at_least_a_pixel
                && bounds.min.as_dvec3().cmple(point.position + near).all()
                && bounds.max.as_dvec3().cmpge(point.position - near).all();
            if !is_candidate {
                return false;
            }
            compared += mesh.triangles.len();
            compared <= MOST_COMPARED
                && (0..mesh.triangles.len() as u32).any(|triangle| {
                    surface_at(world, other, triangle, point.position).is_some_and(|other| {
                        other.normal.dot(normal) > PARALLEL
                            && other.height.abs() <= near
                            && other.beside <= near
                    })
                })
        })
}

/// Surface of a triangle or a capsule beside a point, in world space.
struct NearSurface {
    /// Unit normal of its front.
    normal: DVec3,
    /// Distance of the point from the plane of the triangle, or from the capsule.
    height: f64,
    /// Distance by which the point is beside the triangle; negative over it.
    beside: f64,
}

/// The surface of an instance's triangle or capsule, seen from a point; `None` where it has no size.
fn surface_at(world: &World, instance: &Instance, index: u32, point: DVec3) -> Option<NearSurface> {
    let mesh = &world.meshes[instance.mesh];
    let to_world = in_f64(&instance.world_from_object);
    if let Some(capsule) = Capsule::of_mesh(mesh, index) {
        let to_object = to_world.inverse();
        let inner = to_object.transform_point3(point);
        let (height, normal) = capsule.height(inner);
        let surface = to_world.transform_point3(inner - normal * height);
        return Some(NearSurface {
            normal: (to_object.matrix3.transpose() * normal).try_normalize()?,
            height: surface.distance(point),
            beside: 0.0,
        });
    }
    let corners = world
        .posed(instance.mesh)
        .corners(mesh.triangles[index as usize]);
    let corners = corners.map(|corner| to_world.transform_point3(corner.as_dvec3()));
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let normal = normal.try_normalize()?;
    let beside = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        (b - a).cross(a - point).dot(normal) / a.distance(b)
    };
    Some(NearSurface {
        normal,
        height: (point - corners[0]).dot(normal),
        beside: (0..3).map(beside).fold(f64::MIN, f64::max),
    })
}
