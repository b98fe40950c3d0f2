//! Checks of emitters: materials with `light = true`, and mesh lights of files.

use std::collections::{BTreeSet, HashSet};

use glam::Vec3;

use super::error_at;
use crate::{Mesh, World, emitters::MAX_EMITTERS};
use reflet_scene::{
    desc::{ByName, SceneDesc},
    diagnostic::Diagnostic,
};

/// Refuses materials with `light = true` that emit nothing, by name; mesh lights of files that emit nothing are
/// turned off. `meshes` are the world's.
///
/// # Errors
/// A material that emits nothing, too many triangles.
pub fn check(world: &mut World, meshes: &[Mesh], desc: &SceneDesc) -> Result<(), Vec<Diagnostic>> {
    let mut errors = Vec::new();
    let moving = world.moving.materials.iter().map(|m| m.material);
    let moving: HashSet<_> = moving.collect();
    let written = ByName::from_entries(&desc.materials);
    for index in 0..world.materials.len() {
        let material = &world.materials[index];
        let changes = moving.contains(&index);
        let emits = material.emission != Vec3::ZERO && !material.unlit;
        if !material.light || emits || (changes && !material.unlit) {
            continue;
        }
        let written = written.index(&material.name);
        let written = written.map(|index| &desc.materials[index]);
        match written {
            Some(entry) if entry.value.light == Some(true) => {
                let name = &material.name;
                let text = format!("material \"{name}\" has `light = true`, but emits nothing");
                let error = error_at("emits-nothing", &entry.at, text);
                errors.push(error.help("give it an `emission` above 0, or remove `light`"));
            }
            _ => world.materials[index].light = false,
        }
    }
    keep_mesh_lights_few(world, meshes, desc);
    let moving = &mut world.moving.materials;
    for moving in moving.iter_mut() {
        moving.rest.light = world.materials[moving.material].light;
    }
    check_triangles(world, meshes, desc, &mut errors);
    if errors.is_empty() {
        Ok(())
    } else {
        Err(errors)
    }
}

/// Turns off the mesh lights of files, with a warning, where there are more than [`MAX_EMITTERS`] emitter
/// triangles.
fn keep_mesh_lights_few(world: &mut World, meshes: &[Mesh], desc: &SceneDesc) {
    let (mut of_files, mut of_scene) = (0, 0);
    let mut dropped = BTreeSet::new();
    for (_, instance) in world.lighting_instances() {
        let count = meshes[instance.mesh].triangles.len();
        if world.materials[instance.material].is_mesh_light {
            of_files += count;
            dropped.insert(instance.material);
        } else {
            of_scene += count;
        }
    }
    let Some(first) = dropped
        .first()
        .filter(|_| of_files + of_scene > MAX_EMITTERS)
    else {
        return;
    };
    let others = match of_scene {
        0 => String::new(),
        count => format!(" with the {count} of the scene's own lights"),
    };
    let text = format!(
        "{of_files} triangles of mesh lights{others} exceed the limit of {MAX_EMITTERS}; {} materials shine, but do \
         not light the scene; first: \"{}\"",
        dropped.len(),
        world.materials[*first].name
    );
    for material in world.materials.iter_mut().filter(|m| m.is_mesh_light) {
        material.light = false;
    }
    let warning = error_at("emitters-too-many", &desc.own, text);
    world.warnings.push(warning.warning());
}

fn check_triangles(world: &World, meshes: &[Mesh], desc: &SceneDesc, errors: &mut Vec<Diagnostic>) {
    let mut count = 0;
    for (index, instance) in world.lighting_instances() {
        count += meshes[instance.mesh].triangles.len();
        if count > MAX_EMITTERS {
            let text = format!(
                "with \"{}\", more than {MAX_EMITTERS} triangles have a material with `light = true`",
                instance.name
            );
            let place = world.place_of(desc, index).unwrap_or(&desc.own);
            let error = error_at("emitters-too-many", place, text);
            let help =
                "set `light = true` for fewer or simpler meshes; reflections still show the others";
            errors.push(error.help(help));
            return;
        }
    }
}
