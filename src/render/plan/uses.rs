//! Features that the materials of a scene use.

use serde::Serialize;

use crate::world::{Material, World};

use super::has_specular;

/// Whether some used material has a feature.
fn uses(world: &World, has: fn(&Material) -> bool) -> bool {
    (world.instances.iter()).any(|i| has(&world.materials[i.material]))
}

/// Whether some material may transmit light.
pub fn passes_light(world: &World) -> bool {
    uses(world, Material::passes_light)
}

/// Whether some material has a specular lobe, whose facets may scatter light more than once.
pub fn scatters_twice(world: &World) -> bool {
    uses(world, has_specular)
}

/// Whether some clear coat has, or may get, normals other than those of the layer below.
fn has_coat_normals(world: &World) -> bool {
    let differ = |index: usize| {
        let material = &world.materials[index];
        let is_mapped = material.normal_texture.is_some() && material.clearcoat.is_some();
        material.has_coat_normals() || is_mapped && world.may_change(index)
    };
    world.instances.iter().any(|i| differ(i.material))
}

/// Features of surfaces beyond base color, metalness and roughness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct SurfaceUses {
    /// Whether some surface transmits light.
    pub transmission: bool,
    /// Whether some transmissive solid has dispersion.
    pub dispersion: bool,
    /// Whether some surface has a clear coat.
    pub coats: bool,
    /// Whether some clear coat has normals other than those of the layer below.
    pub coat_normals: bool,
    /// Whether some dielectric's specular lobe has a strength or a color of its own.
    pub tints: bool,
    /// Whether some surface has a sheen.
    pub sheen: bool,
    /// Whether some surface has a thin film.
    pub iridescence: bool,
    /// Whether some specular lobe is anisotropic.
    pub anisotropy: bool,
}

impl SurfaceUses {
    /// Features of the used materials.
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
    /// Whether specular lobes have strengths or colors, their own or those of a thin film.
    pub const fn has_tints(&self) -> bool {
        self.tints || self.iridescence
    }

    /// Whether surfaces have directions beside their normals: clear coat normals or tangents.
    pub const fn has_frames(&self) -> bool {
        self.coat_normals || self.anisotropy
    }
}
