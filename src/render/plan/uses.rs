//! Features that the materials of a scene use.

use reflet_world::{Material, World};

/// Whether some used material has a feature.
fn uses(world: &World, has: fn(&Material) -> bool) -> bool {
    (world.instances.iter()).any(|i| has(&world.materials[i.material]))
}

/// Whether some material may transmit light.
pub fn passes_light(world: &World) -> bool {
    uses(world, Material::passes_light)
}

/// Whether some clear coat has, or may get, normals other than the layer below.
pub fn has_coat_normals(world: &World) -> bool {
    let differ = |index: usize| {
        let material = &world.materials[index];
        let is_mapped = material.normal_texture.is_some() && material.clearcoat.is_some();
        material.has_coat_normals() || is_mapped && world.may_change(index)
    };
    world.instances.iter().any(|i| differ(i.material))
}
