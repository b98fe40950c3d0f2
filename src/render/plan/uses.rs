//! What the materials of a scene ask for.

use crate::world::{Material, World};

use super::has_specular;

/// Whether some material that is used has this.
fn uses(world: &World, has: fn(&Material) -> bool) -> bool {
    (world.instances.iter()).any(|i| has(&world.materials[i.material]))
}

/// Whether some material may let light through.
pub fn passes_light(world: &World) -> bool {
    uses(world, Material::passes_light)
}

/// Whether some lobe has facets that may be in each other's way.
pub fn scatters_twice(world: &World) -> bool {
    uses(world, has_specular)
}

/// Whether some material has a clear coat.
pub fn has_coats(world: &World) -> bool {
    uses(world, |m| m.clearcoat.is_some())
}

/// Whether some clear coat has, or may get, other normals than what is below.
pub fn has_coat_normals(world: &World) -> bool {
    let differ = |index: usize| {
        let material = &world.materials[index];
        let is_mapped = material.normal_texture.is_some() && material.clearcoat.is_some();
        material.has_coat_normals() || is_mapped && world.may_change(index)
    };
    world.instances.iter().any(|i| differ(i.material))
}

/// Whether some dielectric's specular lobe has a strength or a color of its own.
pub fn has_tints(world: &World) -> bool {
    uses(world, |m| {
        m.specular.is_some() || m.specular_color.is_some()
    })
}

/// Whether some material has a sheen.
pub fn has_sheen(world: &World) -> bool {
    uses(world, |m| m.sheen_color.is_some())
}
