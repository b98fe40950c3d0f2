//! Reads the meshes that nodes use, on all cores.

use std::collections::{BTreeSet, HashMap};

use rayon::prelude::*;

use super::{
    Fault, Model, Notes,
    accessor::Data,
    label,
    node::{MeshUse, Primitives, Visit},
    primitive,
    primitive_context::Context,
    schema::{Primitive, Root},
    skin,
};

/// Reads every placed mesh, once for each skin.
///
/// # Errors
/// One for every primitive and skin that is broken.
pub fn read(
    root: &Root,
    data: &Data<'_>,
    visit: &Visit,
    model: &mut Model,
    notes: &mut Notes,
) -> Result<Primitives, Vec<Fault>> {
    let uses: BTreeSet<MeshUse> = visit.mesh_uses().collect();
    let mut poses = HashMap::new();
    for skin in uses.iter().filter_map(|u| u.skin) {
        let pose = skin::pose(root, data, visit, skin);
        poses.insert(skin, pose.map_err(|f| vec![f.at(&format!("skin {skin}"))])?);
    }
    let quantized = (root.extensions_used.iter()).any(|e| e == "KHR_mesh_quantization");
    let primitives = |u: &MeshUse| {
        let u = *u;
        let primitives = root.meshes[u.mesh].primitives.iter().enumerate();
        primitives.map(move |(p, primitive)| (u, p, primitive))
    };
    let jobs: Vec<_> = uses.iter().flat_map(primitives).collect();
    let results: Vec<_> = (jobs.par_iter())
        .map(|(mesh_use, p, primitive)| {
            let mesh = &root.meshes[mesh_use.mesh];
            let name = mesh.name.as_deref();
            let place = format!("{} primitive {p}", label("mesh", mesh_use.mesh, name));
            let mut notes = Notes::default();
            let context = Context {
                data,
                primitive,
                num_vertices: 0,
                rows: None,
                quantized,
                weights: visit.weights(root, mesh_use),
                pose: mesh_use
                    .skin
                    .and_then(|skin| poses.get(&skin))
                    .map(Vec::as_slice),
            };
            let built = primitive::build(context, place.clone(), &mut notes);
            (built.map(|mesh| (mesh, notes))).map_err(|fault| fault.at(&place))
        })
        .collect();
    let mut out = Primitives::new();
    let mut faults = Vec::new();
    for ((mesh_use, _, primitive), result) in jobs.into_iter().zip(results) {
        match result {
            Ok((mesh, new)) => {
                notes.merge(new);
                if let Some(mesh) = mesh {
                    let material = primitive.material.unwrap_or(root.materials.len());
                    let of_variants = variant_materials(primitive);
                    if !of_variants.is_empty() {
                        model
                            .variant_materials
                            .insert(model.meshes.len(), of_variants);
                    }
                    let shown = out.entry(mesh_use).or_default();
                    shown.push((model.meshes.len(), material));
                    model.meshes.push(mesh);
                }
            }
            Err(fault) => faults.push(fault),
        }
    }
    if faults.is_empty() {
        Ok(out)
    } else {
        Err(faults)
    }
}

/// Variant and material of each mapping of KHR_materials_variants.
fn variant_materials(primitive: &Primitive) -> Vec<(usize, usize)> {
    let mappings = primitive
        .extensions
        .variants
        .iter()
        .flat_map(|v| &v.mappings);
    let each = mappings.flat_map(|m| m.variants.iter().map(|variant| (*variant, m.material)));
    each.collect()
}
