//! Rays of a view on the CPU: primary rays, mirror rays and rays towards lights.

use glam::{DVec2, DVec3, UVec2, Vec3};
use rayon::prelude::*;

use reflet_base::math::in_f64;
use reflet_world::{
    Light, World,
    bvh::{Ray, RayHit, Trees, UNREFLECTED, UNSEEN, capsule::Capsule},
};

use crate::settings::view::View;

/// Number of samples across and down the picture.
const GRID: [u32; 2] = [40, 24];

/// Points of a grid over the picture, 0 to 1 from its upper left corner.
pub fn places() -> impl ParallelIterator<Item = DVec2> {
    (0..GRID[0] * GRID[1]).into_par_iter().map(|i| {
        let place = UVec2::new(i % GRID[0], i / GRID[0]).as_dvec2() + 0.5;
        place / UVec2::from(GRID).as_dvec2()
    })
}

/// World and view whose rays are traced.
#[derive(Clone, Copy)]
pub struct ViewRays<'a> {
    /// World in its current pose.
    pub world: &'a World,
    /// BVHs of the world.
    pub trees: &'a Trees,
    /// View of the camera.
    pub view: &'a View,
}

/// A point on a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position in world space, meters.
    pub position: DVec3,
    /// Unit shading normal on the visible side.
    pub normal: DVec3,
    /// Index into [`World::instances`].
    pub instance: usize,
}

impl ViewRays<'_> {
    /// The ray through a point of the picture, 0 to 1 from its upper left corner; its `t` is the depth.
    pub fn primary(&self, place: DVec2) -> Ray {
        let ndc = place * 2.0 - 1.0;
        let (origin, direction) = self.view.ray(DVec2::new(ndc.x, -ndc.y));
        let [t_min, t_max] = self.view.seen_part(origin, direction);
        Ray {
            origin,
            direction,
            t_min,
            t_max,
            passes: UNSEEN,
        }
    }

    /// The ray and the nearest hit at each of [`places`]; its `t` is the depth in meters. `None` where there is none.
    pub fn hits(&self) -> Vec<Option<(Ray, RayHit)>> {
        let hit = |place| {
            let ray = self.primary(place);
            Some((ray, self.trees.nearest(&ray, |_, _, _| true)?))
        };
        places().map(hit).collect()
    }

    /// The surface point of a hit along `direction`; its normal faces the ray.
    pub fn point(&self, hit: &RayHit, direction: DVec3) -> SurfacePoint {
        let instance = &self.world.instances[hit.instance as usize];
        let mesh = &self.world.meshes[instance.mesh];
        if let Some(capsule) = Capsule::of_mesh(mesh, hit.triangle) {
            return self.point_on_capsule(hit, &capsule, direction);
        }
        let posed = self.world.posed(instance.mesh);
        let triangles = &mesh.triangles;
        let corners = triangles[hit.triangle as usize].map(|i| i as usize);
        let weights = [1.0 - hit.bary.x - hit.bary.y, hit.bary.x, hit.bary.y].map(|w| w as f32);
        let mix = |of: &[Vec3]| -> Vec3 { (0..3).map(|k| of[corners[k]] * weights[k]).sum() };
        let to_world = instance.world_from_object;
        let normal = to_world.matrix3.inverse().transpose() * mix(posed.normals);
        let normal = normal.as_dvec3().normalize_or(-direction.normalize());
        let position = to_world.transform_point3(mix(posed.positions)).as_dvec3();
        SurfacePoint {
            position,
            normal: if normal.dot(direction) > 0.0 {
                -normal
            } else {
                normal
            },
            instance: hit.instance as usize,
        }
    }
}

impl ViewRays<'_> {
    /// Unit normal of the front of a surface that is hit; zero for a triangle without area.
    pub fn front(&self, hit: &RayHit) -> DVec3 {
        let instance = &self.world.instances[hit.instance as usize];
        let mesh = &self.world.meshes[instance.mesh];
        let to_world = in_f64(&instance.world_from_object).matrix3;
        if let Some(capsule) = Capsule::of_mesh(mesh, hit.triangle) {
            let (_, normal) = capsule.point(hit.bary);
            return (to_world.inverse().transpose() * normal).normalize_or_zero();
        }
        let posed = self.world.posed(instance.mesh);
        let corners = posed.corners(mesh.triangles[hit.triangle as usize]);
        let [a, b, c] = corners.map(|p| to_world * p.as_dvec3());
        (b - a).cross(c - a).normalize_or_zero() * to_world.determinant().signum()
    }

    fn point_on_capsule(&self, hit: &RayHit, capsule: &Capsule, direction: DVec3) -> SurfacePoint {
        let instance = &self.world.instances[hit.instance as usize];
        let mesh = &self.world.meshes[instance.mesh];
        let corners = mesh.triangles[hit.triangle as usize];
        let (share, normal) = capsule.point(hit.bary);
        let to_world = in_f64(&instance.world_from_object);
        let point = capsule.base + capsule.axis * share + normal * capsule.radius;
        let shaded = match mesh.normals.as_slice() {
            [] => normal,
            normals => {
                let [a, b, _] = corners.map(|i| normals[i as usize].as_dvec3());
                a.lerp(b, share)
            }
        };
        let outward = to_world.matrix3.inverse().transpose() * shaded;
        let outward = outward.normalize_or(-direction.normalize());
        SurfacePoint {
            position: to_world.transform_point3(point),
            normal: outward * -outward.dot(direction).signum(),
            instance: hit.instance as usize,
        }
    }
}

/// Whether a light's cone and range include a point; `to_light` is the vector from the point to the light.
fn is_in_reach(light: &Light, to_light: DVec3) -> bool {
    let kind = &light.desc.kind;
    let direction = kind.direction().unwrap_or_default().as_dvec3();
    let in_cone = match kind.cone_deg() {
        Some([_, outer_deg]) => {
            let cosine = -to_light.normalize().dot(direction.normalize_or_zero());
            cosine > f64::from(outer_deg.to_radians().cos())
        }
        None => !kind.is_flat() || direction.dot(to_light) < 0.0,
    };
    in_cone
        && light
            .range_m
            .is_none_or(|range_m| to_light.length() < f64::from(range_m))
}

/// Direction towards a light, whose length is the way to it, and the share of the way that its ray takes; `None` out
/// of its reach.
pub fn towards(light: &Light, point: &SurfacePoint) -> Option<(DVec3, f64)> {
    let kind = &light.desc.kind;
    let (direction, t_max) = match (kind.position(), kind.direction()) {
        // The ray ends before it meets the light itself.
        (Some(position), _) => (position.as_dvec3() - point.position, 0.9999),
        (None, Some(direction)) => (-direction.as_dvec3(), f64::INFINITY),
        (None, None) => return None,
    };
    is_in_reach(light, direction).then_some((direction, t_max))
}

/// The mirror ray at a surface point that was hit along `direction`.
pub fn mirror_ray(point: &SurfacePoint, direction: DVec3) -> Ray {
    let mirrored = direction - point.normal * (2.0 * direction.dot(point.normal));
    off_surface(point, mirrored.normalize())
}

/// A reflection ray, offset a little from the surface.
pub fn off_surface(point: &SurfacePoint, direction: DVec3) -> Ray {
    let size = point.position.abs().max_element().max(1e-9);
    Ray {
        origin: point.position + point.normal * (size * 1e-4),
        direction,
        t_min: 0.0,
        t_max: f64::INFINITY,
        passes: UNREFLECTED,
    }
}
