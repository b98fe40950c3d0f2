//! What the materials of a scene ask for.

use serde::Serialize;

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

/// Whether some clear coat has, or may get, other normals than what is below.
fn has_coat_normals(world: &World) -> bool {
    let differ = |index: usize| {
        let material = &world.materials[index];
        let is_mapped = material.normal_texture.is_some() && material.clearcoat.is_some();
        material.has_coat_normals() || is_mapped && world.may_change(index)
    };
    world.instances.iter().any(|i| differ(i.material))
}

/// What surfaces have beyond a base color, metalness and roughness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SurfaceUses {
    /// Some surface lets light through.
    pub transmission: bool,
    /// Some of them bends colors differently.
    pub dispersion: bool,
    /// Some surface has a clear coat.
    pub coats: bool,
    /// Some clear coat has other normals than what is below.
    pub coat_normals: bool,
    /// Some dielectric's specular lobe has a strength or a color of its own.
    pub tints: bool,
    /// Some surface has a sheen.
    pub sheen: bool,
    /// Some surface has a thin film.
    pub iridescence: bool,
    /// Some specular lobe is longer one way than the other.
    pub anisotropy: bool,
}

impl SurfaceUses {
    /// Of the materials that are used.
    pub fn of(world: &World) -> Self {
        Self {
            transmission: passes_light(world),
            dispersion: uses(world, |m| {
                m.dispersion.is_some() && m.solid && m.passes_light()
            }),
            coats: uses(world, |m| m.clearcoat.is_some()),
            coat_normals: has_coat_normals(world),
            tints: uses(world, |m| {
                m.specular.is_some() || m.specular_color.is_some()
            }),
            sheen: uses(world, |m| m.sheen_color.is_some()),
            iridescence: uses(world, |m| m.iridescence.is_some()),
            anisotropy: uses(world, |m| m.anisotropy.is_some()),
        }
    }
    /// Whether specular lobes have strengths or colors, if only those that a film gives them.
    pub const fn has_tints(&self) -> bool {
        self.tints || self.iridescence
    }

    /// Whether surfaces have directions beside their normals.
    pub const fn has_frames(&self) -> bool {
        self.coat_normals || self.anisotropy
    }
}
