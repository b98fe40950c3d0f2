//! Reads the meshes that nodes use, on all cores.

use std::{
    collections::{BTreeSet, HashMap},
    sync::Arc,
};

use glam::Affine3A;
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
use crate::world::deform::{DeformingNodes, Joint};

/// A skin at rest.
struct Skin {
    joints: Vec<Joint>,
    /// For each joint: from the mesh to the model.
    pose: Vec<Affine3A>,
    /// Whether animations move some joint.
    is_animated: bool,
}

impl Skin {
    fn read(root: &Root, data: &Data<'_>, visit: &Visit, skin: usize) -> Result<Self, Fault> {
        let joints = skin::joints(root, data, visit, skin)?;
        let posed = |joint: &Joint| {
            let model_from_node = visit.model_from_node(joint.node);
            model_from_node.unwrap_or_default() * joint.node_from_mesh
        };
        Ok(Self {
            pose: joints.iter().map(posed).collect(),
            is_animated: joints.iter().any(|joint| visit.moves(joint.node)),
            joints,
        })
    }
}

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
    let mut skins = HashMap::new();
    for index in uses.iter().filter_map(|u| u.skin) {
        let skin = Skin::read(root, data, visit, index);
        skins.insert(
            index,
            skin.map_err(|f| vec![f.at(&format!("skin {index}"))])?,
        );
    }
    let uv_sets = &model.uv_sets;
    let skin_of = |u: &MeshUse| u.skin.and_then(|skin| skins.get(&skin));
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
                uv_sets: uv_sets
                    .get(primitive.material.unwrap_or(root.materials.len()))
                    .map_or([0, 1], |sets| *sets),
                quantized,
                weights: visit.weights(root, mesh_use),
                has_animated_weights: visit.animated_weights(mesh_use).is_some(),
                pose: skin_of(mesh_use).map(|skin| skin.pose.as_slice()),
                has_animated_joints: skin_of(mesh_use).is_some_and(|skin| skin.is_animated),
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
                    if mesh.deformation.is_some() {
                        let nodes = DeformingNodes {
                            joints: skin_of(&mesh_use)
                                .map_or_else(Vec::new, |skin| skin.joints.clone()),
                            weights: visit.animated_weights(&mesh_use),
                            rest_weights: visit.weights(root, &mesh_use).to_vec(),
                        };
                        model.deforming.insert(model.meshes.len(), Arc::new(nodes));
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
