//! Drops alpha blending from materials that are opaque everywhere: many files mark opaque materials as blended.

use crate::{Instance, Mesh, Texture, World, pose::MaterialSource};

/// Makes materials opaque that are blended although their alpha is 1 everywhere, so that they need no blending.
/// `meshes` and `textures` are the world's.
pub fn drop_opaque(world: &mut World, meshes: &[Mesh], textures: &[Texture]) {
    let has_clear_corners =
        |instance: &Instance| meshes[instance.mesh].colors.iter().any(|c| c.w < 1.0);
    for index in 0..world.materials.len() {
        let material = &world.materials[index];
        // A material that the scene text animates may have another alpha in other frames.
        let is_moving = (world.moving.materials.iter())
            .any(|m| m.material == index && !matches!(m.from, MaterialSource::File { .. }));
        if !material.blended || material.base_color.w < 1.0 || is_moving {
            continue;
        }
        let texture = material.base_color_texture.map(|t| &textures[t.texture]);
        let has_clear_texels = texture.is_some_and(|t| t.rgba.chunks_exact(4).any(|p| p[3] < 255));
        let mut users = (world.instances.iter()).filter(|i| i.material == index);
        if !has_clear_texels && !users.any(has_clear_corners) {
            world.materials[index].blended = false;
        }
    }
    for moving in &mut world.moving.materials {
        moving.rest.blended = world.materials[moving.material].blended;
    }
}
