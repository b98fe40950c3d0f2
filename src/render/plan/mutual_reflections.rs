//! Test whether reflectors may see each other, so that rays bounce more than once.

use glam::Vec3;

use super::may_reflect;
use reflet_world::World;

/// Maximum number of (plane, vertex) pairs to test before the answer is "perhaps".
const MAX_PAIRS: usize = 1 << 22;

/// Whether a ray from one reflector may hit another (or the same one): conservative, true unless every reflector
/// vertex lies on or behind the plane of every reflector triangle, from its visible sides.
pub(super) fn reflectors_see_each_other(world: &World, cutoff: f32) -> bool {
    let mut planes: Vec<(Vec3, f32, bool)> = Vec::new();
    let mut points: Vec<Vec3> = Vec::new();
    let scale = world.unit_m() * 16.0;
    for instance in &world.instances {
        let material = &world.materials[instance.material];
        if !may_reflect(world, instance.material, cutoff) {
            continue;
        }
        let are_capsules = world.meshes[instance.mesh].capsule_radius_m.is_some();
        if instance.dynamic || are_capsules {
            return true;
        }
        let (mesh, posed) = (&world.meshes[instance.mesh], world.posed(instance.mesh));
        let place = |i: u32| {
            instance
                .world_from_object
                .transform_point3(posed.positions[i as usize])
        };
        let mirrored = instance.world_from_object.matrix3.determinant() < 0.0;
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(place);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let normal = if mirrored { -normal } else { normal };
            let plane = (normal, normal.dot(a), material.double_sided);
            let known = |p: &&(Vec3, f32, bool)| {
                p.0.dot(normal) > 0.999_999
                    && (p.1 - plane.1).abs() < 1e-5 * scale
                    && p.2 == plane.2
            };
            if planes.iter().rev().take(64).find(known).is_none() {
                planes.push(plane);
            }
            points.extend([a, b, c]);
            if planes.len() * points.len() > MAX_PAIRS {
                return true;
            }
        }
    }
    planes.iter().any(|&(normal, offset, double_sided)| {
        points.iter().any(|p| {
            let height = normal.dot(*p) - offset;
            height > 1e-4 * scale || (double_sided && height < -1e-4 * scale)
        })
    })
}
