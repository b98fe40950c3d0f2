//! What meshes need only because of the materials they meet: tangents and second texture
//! coordinates, made where needed and dropped elsewhere.

use glam::Vec2;
use rayon::prelude::*;

use super::tangent;
use crate::{
    scene::diagnostic::{Diagnostic, Severity, Span},
    world::{Mesh, World},
};

#[derive(Clone, Copy, Default)]
struct Needs {
    /// Which texture coordinates a normal map uses.
    tangents_from: Option<u32>,
    uv1: bool,
}

/// Brings every mesh into the form that its materials need.
pub fn run(world: &mut World) {
    let mut needs = vec![Needs::default(); world.meshes.len()];
    for instance in &world.instances {
        let material = &world.materials[instance.material];
        let need = &mut needs[instance.mesh];
        if let Some(normal) = &material.normal_texture {
            need.tangents_from.get_or_insert(normal.uv_set);
        }
        let textures = [
            &material.base_color_texture,
            &material.metallic_roughness_texture,
            &material.normal_texture,
            &material.occlusion_texture,
            &material.emission_texture,
        ];
        need.uv1 |= textures.into_iter().flatten().any(|t| t.uv_set == 1);
    }
    let warnings: Vec<_> = (world.meshes.par_iter_mut())
        .zip(needs)
        .filter_map(|(mesh, need)| finish(mesh, need))
        .collect();
    world.warnings.extend(warnings);
}

fn finish(mesh: &mut Mesh, need: Needs) -> Option<Diagnostic> {
    let missing = need.uv1 && mesh.uv1.is_empty();
    if !need.uv1 {
        mesh.uv1 = Vec::new();
    } else if missing {
        mesh.uv1 = vec![Vec2::ZERO; mesh.positions.len()];
    }
    match need.tangents_from {
        None => mesh.tangents = Vec::new(),
        Some(uv_set) if mesh.tangents.is_empty() => tangent::generate(mesh, uv_set),
        Some(_) => {}
    }
    missing.then(|| Diagnostic {
        severity: Severity::Warning,
        name: "uv-missing",
        message: format!(
            "{}: a texture uses TEXCOORD_1, which the mesh lacks; 0 is used",
            mesh.name
        ),
        span: Span::default(),
        file: None,
        help: None,
        related: None,
    })
}
