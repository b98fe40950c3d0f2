//! Decals that are turned away from all surfaces in their boxes, and reliefs that decals leave out.

use glam::{Quat, Vec3};

use super::text::warning;
use crate::{
    math::Bounds,
    scene::{desc::PlacementDesc, diagnostic::Diagnostic, stages::Scene},
    world::World,
};

/// Largest number of triangles that are looked at; scenes with more are not checked.
const MOST_TRIANGLES: usize = 1_000_000;

/// Rotations of scene text that turn +Z to each axis, as a normal and its `rotation_deg`.
const TURNS: [(Vec3, &str); 6] = [
    (Vec3::Y, "[-90, 0, 0]"),
    (Vec3::NEG_Y, "[90, 0, 0]"),
    (Vec3::X, "[0, 90, 0]"),
    (Vec3::NEG_X, "[0, -90, 0]"),
    (Vec3::Z, "[0, 0, 0]"),
    (Vec3::NEG_Z, "[0, 180, 0]"),
];

/// Warnings about decals of the scene text.
pub fn lint(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let placed = scene.decals.iter().zip(&world.decals.list);
    let left_out = placed.filter(|(_, decal)| world.materials[decal.material].has_relief());
    let reliefs = left_out.map(|(entry, _)| {
        let at = &entry.value.material;
        let message = format!(
            "decal \"{}\" leaves out the relief `bump` of material \"{}\"",
            entry.name, at.value
        );
        let help = "write a `normal_texture` in place of `bump`, or use a material without it";
        warning("ignored-key", &at.at, message, help)
    });
    reliefs.chain(turned(scene, world)).collect()
}

/// Warnings about decals whose boxes have surfaces at rest, all of them at a larger angle than the decal covers.
fn turned(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let triangles = world
        .instances
        .iter()
        .map(|it| world.meshes[it.mesh].triangles.len());
    let most = MOST_TRIANGLES / scene.decals.len().max(1);
    if triangles.sum::<usize>() > most {
        return Vec::new();
    }
    let moving = scene.desc.moving_decals();
    let decals = scene.decals.iter().enumerate().zip(moving);
    let found = decals.filter(|(_, moves)| !moves).filter_map(|((index, entry), _)| {
        let (instance, normal) = turned_away(world, index)?;
        let name = &world.instances[instance].name;
        let message = format!(
            "decal \"{}\" is turned away from \"{name}\", the surface in its box, so it is not seen",
            entry.name
        );
        // Below a parent, and beside a rotation of another form, the turn is another one.
        let is_unturned = matches!(entry.value.placement, PlacementDesc::Trs { rotation, .. } if rotation == Quat::IDENTITY);
        let is_free = is_unturned && scene.parents.of_decal(index).is_none();
        let turn = TURNS.iter().find(|(axis, _)| is_free && axis.dot(normal) > 0.99);
        let help = match turn {
            Some((_, turn)) => format!("write `rotation_deg = {turn}`: its +Z has to point as the surface does"),
            None => "turn its +Z to where the surface looks".to_owned(),
        };
        Some(warning("unseen-decal", &entry.at, message, &help))
    });
    found.collect()
}

/// The first instance at rest in the box of a decal, with a unit normal, if the box has triangles and the decal covers none.
fn turned_away(world: &World, index: usize) -> Option<(usize, Vec3)> {
    let decal = world.decals.list.get(index)?;
    let to_box = decal.world_from_box().inverse();
    let forward = Vec3::from(decal.world_from_decal.matrix3 * glam::Vec3A::Z).normalize_or_zero();
    let mut first = None;
    let shown = (0..world.instances.len()).filter(|it| world.decals.may_show(*it, index));
    for number in shown {
        let instance = &world.instances[number];
        let mesh = &world.meshes[instance.mesh];
        if instance.dynamic || mesh.capsule_radius_m.is_some() {
            return None; // it may come to face the decal, or faces all ways
        }
        let both = world.materials[instance.material].double_sided;
        let posed = world.posed(instance.mesh);
        for triangle in &mesh.triangles {
            let corners = posed
                .corners(*triangle)
                .map(|at| instance.world_from_object.transform_point3(at));
            let mut bounds = Bounds::EMPTY;
            for at in corners.map(|at| to_box.transform_point3(at)) {
                bounds = bounds.union(Bounds { min: at, max: at });
            }
            let is_inside = bounds.min.cmple(Vec3::splat(0.5)).all()
                && bounds.max.cmpge(Vec3::splat(-0.5)).all();
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let Some(normal) = normal.try_normalize().filter(|_| is_inside) else {
                continue;
            };
            let faces =
                |normal: Vec3| normal.angle_between(forward).to_degrees() <= decal.max_angle_deg;
            if faces(normal) || both && faces(-normal) {
                return None;
            }
            first.get_or_insert((number, normal));
        }
    }
    first
}
