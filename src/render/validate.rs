//! Checks a world before it is uploaded: shaders follow its indices without looking.

use crate::{scene::diagnostic::Diagnostic, world::World};

use super::error::RenderError;

/// Checks every index that the shaders follow, so that the tracing module may run unchecked.
///
/// # Errors
/// The first mesh or instance whose indices point outside.
pub fn check_world(world: &World) -> Result<(), RenderError> {
    let refuse = |message: String| {
        let file = std::path::Path::new("scene");
        Err(Box::new(Diagnostic::in_file("index-out-of-range", file, message)).into())
    };
    for mesh in &world.meshes {
        let count = mesh.positions.len();
        let attributes = [mesh.normals.len(), mesh.uv0.len()];
        let optional = [mesh.tangents.len(), mesh.uv1.len(), mesh.colors.len()];
        if attributes.iter().any(|n| *n != count) || optional.iter().any(|n| *n != 0 && *n != count)
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
    for instance in &world.instances {
        if instance.mesh >= world.meshes.len() || instance.material >= world.materials.len() {
            return refuse(format!(
                "instance \"{}\": its mesh or material does not exist",
                instance.name
            ));
        }
    }
    let textures = world.materials.iter().flat_map(|m| m.slots()).flatten();
    for slot in textures {
        if slot.texture >= world.textures.len() {
            return refuse("a material's texture does not exist".to_owned());
        }
    }
    Ok(())
}
