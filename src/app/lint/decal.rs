//! Decals that are turned away from all surfaces in their boxes.

use glam::{DVec3, Vec3};

use super::{overlap::surface_at, text::warning};
use crate::{
    math::in_f64,
    scene::{diagnostic::Diagnostic, stages::Scene},
    world::{
        World,
        bvh::{Ray, Trees, UNREFLECTED},
    },
};

/// Places of rays along an edge of a decal's box, as shares of its length from its center.
const PLACES: [f64; 5] = [-0.45, -0.2, 0.0, 0.2, 0.45];

/// Rotations of scene text that turn +Z to each axis, as a normal and its `rotation_deg`.
const TURNS: [(Vec3, &str); 6] = [
    (Vec3::Y, "[-90, 0, 0]"),
    (Vec3::NEG_Y, "[90, 0, 0]"),
    (Vec3::X, "[0, 90, 0]"),
    (Vec3::NEG_X, "[0, -90, 0]"),
    (Vec3::Z, "[0, 0, 0]"),
    (Vec3::NEG_Z, "[0, 180, 0]"),
];

/// Warnings about decals at rest whose boxes have surfaces, all of them at a larger angle than the decal covers.
pub fn lint(scene: &Scene, world: &World, trees: &Trees) -> Vec<Diagnostic> {
    let moving = scene.desc.moving_decals();
    let decals = scene.decals.iter().enumerate().zip(moving);
    let found = decals.filter(|(_, moves)| !moves).filter_map(|((index, entry), _)| {
        let (instance, normal) = turned_away(world, trees, index)?;
        let name = &world.instances[instance].name;
        let message = format!(
            "decal \"{}\" is turned away from \"{name}\", the surface in its box, so it is not seen",
            entry.name
        );
        let turn = TURNS.iter().find(|(axis, _)| axis.dot(normal) > 0.99);
        let help = match turn {
            Some((_, turn)) => format!("write `rotation_deg = {turn}`: its +Z has to point as the surface does"),
            None => format!("turn its +Z along the surface's normal, {normal:.2}"),
        };
        Some(warning("unseen-decal", &entry.at, message, &help))
    });
    found.collect()
}

/// An instance in the box of a decal with its unit normal, if rays through the box meet surfaces and the decal covers none.
fn turned_away(world: &World, trees: &Trees, index: usize) -> Option<(usize, Vec3)> {
    let decal = world.decals.list.get(index)?;
    let from_box = in_f64(&decal.world_from_box());
    let forward = Vec3::from(decal.world_from_decal.matrix3 * glam::Vec3A::Z).normalize_or_zero();
    let mut first = None;
    // The box projects along -Z, so that rays along this axis come first.
    for (axis, sign) in [2, 0, 1]
        .into_iter()
        .flat_map(|axis| [(axis, 0.5), (axis, -0.5)])
    {
        for (u, v) in PLACES.into_iter().flat_map(|u| PLACES.map(|v| (u, v))) {
            let place = |along: f64| {
                let mut at = DVec3::ZERO;
                (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (along, u, v);
                from_box.transform_point3(at)
            };
            let (origin, way) = (place(sign), place(-sign) - place(sign));
            let direction = way.normalize_or_zero();
            let ray = Ray {
                origin,
                direction,
                t_min: 0.0,
                t_max: way.length(),
                passes: UNREFLECTED,
            };
            let Some(hit) = trees.nearest(&ray, |_, _, _| true) else {
                continue;
            };
            let number = hit.instance as usize;
            let instance = &world.instances[number];
            let at = origin + direction * hit.t;
            let shown = world.decals.may_show(number, index);
            let surface = surface_at(world, instance, hit.triangle, at).filter(|_| shown);
            let Some(surface) = surface else {
                continue;
            };
            let normal = surface.normal.as_vec3();
            let faces =
                |normal: Vec3| normal.angle_between(forward).to_degrees() <= decal.max_angle_deg;
            let both = world.materials[instance.material].double_sided;
            if faces(normal) || both && faces(-normal) {
                return None;
            }
            first.get_or_insert((number, normal));
        }
    }
    first
}
