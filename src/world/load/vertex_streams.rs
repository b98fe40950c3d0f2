//! Vertex streams that depend on materials: tangents and second texture coordinates, generated
//! where needed and dropped elsewhere.

use std::sync::Arc;

use glam::Vec2;
use rayon::prelude::*;

use super::tangent;
use crate::{LayerTexture, Material, Mesh, World, normal_uv::NormalUv};
use reflet_base::guard;
use reflet_scene::{
    desc::{PatternedDesc, PatternedKey},
    diagnostic::{Diagnostic, Severity, Span},
};

/// Streams that a mesh needs for its materials.
#[derive(Clone, Copy, Debug, Default)]
pub struct Needs {
    /// Texture coordinates of the normal map that tangents follow; `None`: no tangents are needed.
    tangents_from: Option<NormalUv>,
    /// Whether two materials want tangents of different coordinates.
    tangents_differ: bool,
    uv1: bool,
    /// Whether a mesh that could be round needs its triangles.
    triangles: bool,
}

impl Needs {
    /// Whether streams generated for `self` suffice for `other`.
    pub fn cover(self, other: Self) -> bool {
        let tangents = other.tangents_from.is_none() || other.tangents_from == self.tangents_from;
        tangents && (self.uv1 || !other.uv1) && self.triangles == other.triangles
    }
}

/// Streams needed by the materials of each mesh.
pub fn needs(world: &World) -> Vec<Needs> {
    let mut needs = vec![Needs::default(); world.meshes.len()];
    for instance in &world.instances {
        let material = &world.materials[instance.material];
        let need = &mut needs[instance.mesh];
        let layer = |which| {
            material
                .layer_texture(which)
                .as_ref()
                .map(NormalUv::from_map)
        };
        let wanted = (material.normal_texture.as_ref().map(NormalUv::from_map))
            .or_else(|| layer(LayerTexture::ClearcoatNormal))
            .or_else(|| layer(LayerTexture::Anisotropy))
            .or_else(|| material.anisotropy.map(|_| NormalUv::PLAIN));
        if let Some(uv) = wanted {
            need.tangents_differ |= *need.tangents_from.get_or_insert(uv) != uv;
        }
        let mesh = &world.meshes[instance.mesh];
        need.triangles |= mesh.round.is_some() && has_faces(material);
        let textures = material.textures();
        need.uv1 |= textures.into_iter().flatten().any(|t| t.uv_set == 1);
    }
    needs
}

/// Whether a material needs triangles: for texture coordinates, to emit light from them, or as holes of exact surfaces
/// do not follow patterns.
fn has_faces(material: &Material) -> bool {
    let varies = |p: &PatternedDesc| p.value == PatternedKey::Alpha;
    material.textures().iter().any(Option::is_some)
        || material.anisotropy.is_some()
        || material.light
        || material.patterned.iter().any(varies)
}

/// Generates or drops the vertex streams of every mesh, within the world's memory.
///
/// # Errors
/// `memory-short`; `internal` where the tangent generator panicked on a mesh.
pub fn run(world: &mut World, needs: &[Needs]) -> Result<(), Vec<Diagnostic>> {
    let memory = world.memory.clone();
    let messages: Vec<_> = (world.meshes.par_iter_mut())
        .zip(needs)
        .flat_map_iter(|(mesh, need)| {
            let before = mesh.bytes();
            let mut messages = finish(mesh, need);
            if !memory.take(mesh.bytes().saturating_sub(before)) {
                messages.push(short(mesh));
            }
            messages
        })
        .collect();
    let is_error = |d: &Diagnostic| d.severity == Severity::Error;
    let (errors, warnings): (Vec<_>, Vec<_>) = messages.into_iter().partition(is_error);
    world.warnings.extend(warnings);
    if errors.is_empty() {
        Ok(())
    } else {
        Err(errors)
    }
}

fn finish(mesh: &mut Mesh, need: &Needs) -> Vec<Diagnostic> {
    let mut messages = Vec::new();
    if let Some(round) = mesh.round.filter(|_| !need.triangles) {
        mesh.make_round(round);
        return messages;
    }
    if !need.uv1 {
        mesh.uv1 = Vec::new();
    } else if mesh.uv1.is_empty() {
        mesh.uv1 = vec![Vec2::ZERO; mesh.positions.len()];
        let text = "a texture uses coordinates that the mesh lacks; 0 is used";
        messages.push(error("uv-missing", mesh, text).warning());
    }
    // Capsules have no tangents, as they have no faces with texture coordinates.
    match need
        .tangents_from
        .filter(|_| mesh.capsule_radius_m.is_none())
    {
        None => {
            mesh.tangents = Vec::new();
            if let Some(deformation) = &mut mesh.deformation {
                Arc::make_mut(deformation).bind.tangents = Vec::new();
            }
        }
        Some(uv) if mesh.tangents.is_empty() => {
            if need.tangents_differ {
                let text = "its materials use normal maps with different coordinates; the tangents fit \
                            the first one";
                messages.push(error("tangents-shared", mesh, text).warning());
            }
            // Panic boundary: a third-party library processes untrusted geometry.
            if let Some(deformation) = &mut mesh.deformation
                && let Some(scripted) = &mut Arc::make_mut(deformation).scripted
            {
                scripted.tangents_from = Some(uv);
            }
            mesh.swap_bind();
            let has_panicked = guard::catch(|| tangent::generate(mesh, &uv)).is_none();
            mesh.swap_bind();
            if let Some(deformation) = &mesh.deformation {
                mesh.tangents.clone_from(&deformation.bind.tangents);
            }
            if has_panicked {
                let text = "generating its tangents panicked; please report this";
                messages.push(error("internal", mesh, text));
            }
        }
        Some(_) => {}
    }
    messages
}

fn short(mesh: &Mesh) -> Diagnostic {
    let text =
        "there is not enough memory for the vertex data that its materials need, such as tangents";
    let help = "simplify the model, or render where there is more memory";
    error("memory-short", mesh, text).help(help)
}

fn error(name: &'static str, mesh: &Mesh, text: &str) -> Diagnostic {
    Diagnostic::new(name, Span::default(), format!("{}: {text}", mesh.name))
}
