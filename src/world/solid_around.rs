//! The solid that a point is in, among solids that light enters.

use glam::Vec3;

use super::{
    Material, World,
    bvh::{Ray, Trees},
};

/// Number of surfaces that are passed on the way out of the solid.
const MOST_PASSED: usize = 256;

/// Material of the innermost solid with a medium around a point; `None` where the point is in none. A ray upwards tells: it
/// leaves the solid before it enters it.
pub fn solid_around<'a>(world: &'a World, trees: &Trees, point: Vec3) -> Option<&'a Material> {
    let material = |instance: usize| &world.materials[world.instances[instance].material];
    let is_solid = |i: usize| material(i).has_medium();
    let is_near = |i: usize| {
        let bounds = world.bounds_of(&world.instances[i]);
        is_solid(i) && point.cmpge(bounds.min).all() && point.cmple(bounds.max).all()
    };
    if !(0..world.instances.len()).any(is_near) {
        return None;
    }
    let mut ray = Ray {
        origin: point.as_dvec3(),
        direction: glam::DVec3::new(0.021, 1.0, 0.013), // off the edges and diagonals of placed boxes
        t_min: 0.0,
        t_max: f64::INFINITY,
        passes: 0,
    };
    let mut entered = Vec::new();
    for _ in 0..MOST_PASSED {
        let hit = trees.nearest(&ray, |_, _, _| true)?;
        ray.t_min = hit.t;
        let i = hit.instance as usize;
        if !is_solid(i) {
            continue;
        }
        let instance = &world.instances[i];
        let corners = world.meshes[instance.mesh].triangles[hit.triangle as usize];
        let [a, b, c] = world.posed(instance.mesh).corners(corners);
        let to_world = instance.world_from_object.matrix3;
        let normal =
            (to_world * (b - a)).cross(to_world * (c - a)) * to_world.determinant().signum();
        if normal.as_dvec3().dot(ray.direction) < 0.0 {
            entered.push(i);
        } else if let Some(at) = entered.iter().rposition(|e| *e == i) {
            entered.remove(at);
        } else {
            return Some(material(i));
        }
    }
    None
}
