//! World validation before upload: shaders use the world's indices unchecked.

use std::path::Path;

use reflet_scene::desc::SceneDesc;
use reflet_scene::diagnostic::Diagnostic;
use reflet_world::{MAX_LIGHTS, Material, World};

use crate::error::RenderError;

/// Validates every index that the shaders use, so that the trace module can run without bounds
/// checks.
///
/// # Errors
/// The first mesh, instance or material with an index out of range, and too many lights.
pub fn check_world(world: &World) -> Result<(), RenderError> {
    for mesh in &world.meshes {
        let count = mesh.positions.len();
        let attributes = [mesh.normals.len(), mesh.uv0.len()];
        let optional = [mesh.tangents.len(), mesh.uv1.len(), mesh.colors.len()];
        let differs = |n: &usize| *n != 0 && *n != count;
        let needs_all = mesh.capsule_radius_m.is_none();
        if attributes.iter().any(|n| needs_all && *n != count)
            || attributes.iter().chain(&optional).any(differs)
        {
            return refuse(format!(
                "mesh \"{}\": its attributes differ in length",
                mesh.name
            ));
        }
        if mesh
            .triangles
            .iter()
            .flatten()
            .any(|i| *i as usize >= count)
        {
            return refuse(format!(
                "mesh \"{}\": an index points past its {count} vertices",
                mesh.name
            ));
        }
    }
    check_deformed(world)?;
    for instance in &world.instances {
        if instance.mesh >= world.meshes.len() || instance.material >= world.materials.len() {
            return refuse(format!(
                "instance \"{}\": its mesh or material does not exist",
                instance.name
            ));
        }
    }
    if world
        .decals
        .list
        .iter()
        .any(|d| d.material >= world.materials.len())
    {
        return refuse("a decal's material does not exist".to_owned());
    }
    for texture in world.textures.iter() {
        let bytes: usize = texture.levels().map(|(_, level)| level.len()).sum();
        let has_texels = texture.width > 0 && texture.height > 0;
        if !has_texels || bytes == 0 || texture.rgba.len() != bytes {
            return refuse(format!(
                "texture \"{}\": {} bytes for {} x {} pixels",
                texture.name,
                texture.rgba.len(),
                texture.width,
                texture.height
            ));
        }
    }
    for material in &world.materials {
        check_material(world, material)?;
    }
    check_lights(world)
}

/// Validates the vertices of deformed meshes.
///
/// # Errors
/// The first mesh whose deformed vertices differ in number from its own.
pub fn check_deformed(world: &World) -> Result<(), RenderError> {
    for (index, deformed) in &world.deformed {
        let Some(mesh) = world.meshes.get(*index) else {
            return refuse(format!("mesh {index} is deformed, but does not exist"));
        };
        let vertices = &deformed.vertices;
        let counts = [
            vertices.positions.len(),
            vertices.normals.len(),
            vertices.tangents.len(),
        ];
        if counts
            != [
                mesh.positions.len(),
                mesh.normals.len(),
                mesh.tangents.len(),
            ]
        {
            let name = &mesh.name;
            return refuse(format!(
                "mesh \"{name}\": its deformed vertices differ in number from its own"
            ));
        }
    }
    Ok(())
}

/// Validates the animated materials and their textures.
///
/// # Errors
/// The first invalid one.
pub fn check_moving_materials(world: &World) -> Result<(), RenderError> {
    for moving in &world.moving.materials {
        match world.materials.get(moving.material) {
            Some(material) => check_material(world, material)?,
            None => return refuse("an animated material does not exist".to_owned()),
        }
    }
    Ok(())
}

fn check_material(world: &World, material: &Material) -> Result<(), RenderError> {
    let mut slots = material.slots().into_iter().flatten();
    match slots.find(|slot| slot.texture >= world.textures.len()) {
        Some(_) => refuse(format!(
            "material \"{}\": its texture does not exist",
            material.name
        )),
        None => Ok(()),
    }
}

/// Checks that the lights fit their uniform block, and the lamps the light tree.
///
/// # Errors
/// More lights than [`MAX_LIGHTS`], or more lamps than [`SceneDesc::MOST_LIGHTS`].
pub fn check_lights(world: &World) -> Result<(), RenderError> {
    let (lights, lamps) = (world.lights.len(), world.lamps.len());
    if lights > MAX_LIGHTS {
        return refuse(format!(
            "{lights} lights: a scene has at most {MAX_LIGHTS} that are not lamps of the light tree"
        ));
    }
    match lamps {
        n if n > SceneDesc::MOST_LIGHTS => refuse(format!(
            "{n} lamps: a scene has at most {}",
            SceneDesc::MOST_LIGHTS
        )),
        _ => Ok(()),
    }
}

/// Error of an invalid world.
pub(crate) fn refuse(message: String) -> Result<(), RenderError> {
    let file = Path::new("scene");
    Err(Box::new(Diagnostic::in_file("index-out-of-range", file, message)).into())
}
