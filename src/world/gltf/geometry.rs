//! Reads the meshes that nodes use, on all cores.

use std::{
    collections::{BTreeSet, HashMap, hash_map::Entry},
    sync::Arc,
};

use glam::Affine3A;
use rayon::prelude::*;

use super::{
    Fault, Model, Notes,
    accessor::Data,
    label,
    least_bytes::least_bytes,
    node::{MeshUse, Primitives, Visit},
    primitive,
    primitive_context::Context,
    schema::{Primitive, Root},
    skin,
};
use crate::{
    Mesh,
    deform::{DeformingNodes, Joint},
};

/// A skin at rest.
struct Skin {
    joints: Vec<Joint>,
    /// Transform of each joint, from the mesh's space to the model's.
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

/// A use of a mesh, with the index and the content of one of its primitives.
type Job<'a> = (MeshUse, usize, &'a Primitive);

/// Context that all primitives of a file share.
struct Reader<'a> {
    root: &'a Root,
    data: &'a Data<'a>,
    visit: &'a Visit,
    /// Sets of texture coordinates of each material.
    uv_sets: Vec<[u32; 2]>,
    quantized: bool,
    skins: HashMap<usize, Skin>,
}

impl Reader<'_> {
    fn skin_of(&self, mesh_use: &MeshUse) -> Option<&Skin> {
        mesh_use.skin.and_then(|skin| self.skins.get(&skin))
    }

    fn context<'a>(&'a self, (mesh_use, _, primitive): &Job<'a>) -> Context<'a> {
        let material = primitive.material.unwrap_or(self.root.materials.len());
        let skin = self.skin_of(mesh_use);
        Context {
            root: self.root,
            data: self.data,
            primitive,
            num_vertices: 0,
            rows: None,
            uv_sets: (self.uv_sets.get(material)).map_or([0, 1], |sets| *sets),
            quantized: self.quantized,
            weights: self.visit.weights(self.root, mesh_use),
            has_animated_weights: self.visit.animated_weights(mesh_use).is_some(),
            pose: skin.map(|skin| skin.pose.as_slice()),
            has_animated_joints: skin.is_some_and(|skin| skin.is_animated),
            is_mirrored: mesh_use.is_mirrored,
        }
    }

    /// Name of a primitive for messages.
    fn place(&self, mesh_use: &MeshUse, p: usize) -> String {
        let name = self.root.meshes[mesh_use.mesh].name.as_deref();
        format!("{} primitive {p}", label("mesh", mesh_use.mesh, name))
    }

    /// Refuses geometry that cannot fit in the budget, before any of it is read.
    fn check_budget<'a>(&'a self, jobs: impl Iterator<Item = Job<'a>>) -> Result<(), Vec<Fault>> {
        let mut faults = Faults::default();
        let mut least = 0_u64;
        for job in jobs {
            if !faults.is_empty() {
                faults.repeat_last();
                continue;
            }
            least = least.saturating_add(least_bytes(&self.context(&job)));
            if let Err(fault) = self.data.budget.check(least) {
                faults.add(fault, || self.place(&job.0, job.1));
            }
        }
        match faults.is_empty() {
            true => Ok(()),
            false => Err(faults.into_all()),
        }
    }

    fn build<'a>(&'a self, job: &Job<'a>) -> Result<(Option<Mesh>, Notes), Fault> {
        self.data.budget.check_not_exceeded()?;
        let mut notes = Notes::default();
        let place = self.place(&job.0, job.1);
        let mesh = primitive::build(self.context(job), place, &mut notes)?;
        Ok((mesh, notes))
    }
}

/// Reads every placed mesh, once for each skin.
///
/// # Errors
/// The first broken skin, else every broken primitive; equal errors are merged.
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
            skin.map_err(|f| vec![f.placed(&format!("skin {index}"))])?,
        );
    }
    let reader = Reader {
        root,
        data,
        visit,
        uv_sets: model.uv_sets.clone(),
        quantized: (root.extensions_used.iter()).any(|e| e == "KHR_mesh_quantization"),
        skins,
    };
    let primitives = uses.iter().flat_map(|mesh_use| {
        let primitives = root.meshes[mesh_use.mesh].primitives.iter().enumerate();
        primitives.map(|(p, primitive)| (*mesh_use, p, primitive))
    });
    reader.check_budget(primitives.clone())?;
    let jobs: Vec<_> = primitives.collect();
    let results: Vec<_> = jobs.par_iter().map(|job| reader.build(job)).collect();
    let mut faults = Faults::default();
    let mut out = Primitives::new();
    let mut unlit = UnlitMaterials::default();
    for ((mesh_use, p, primitive), result) in jobs.into_iter().zip(results) {
        match result {
            Ok((mesh, new)) => {
                notes.merge(new);
                if let Some(mesh) = mesh {
                    let mut number = primitive.material.unwrap_or(root.materials.len());
                    let mut of_variants = variant_materials(primitive);
                    if primitive::is_without_light(primitive) {
                        number = unlit.index_of(model, number);
                        for (_, number) in &mut of_variants {
                            *number = unlit.index_of(model, *number);
                        }
                    }
                    if !of_variants.is_empty() {
                        model
                            .variant_materials
                            .insert(model.meshes.len(), of_variants);
                    }
                    if mesh.deformation.is_some() {
                        let nodes = DeformingNodes {
                            joints: reader
                                .skin_of(&mesh_use)
                                .map_or_else(Vec::new, |skin| skin.joints.clone()),
                            weights: visit.animated_weights(&mesh_use),
                            rest_weights: visit.weights(root, &mesh_use).to_vec(),
                        };
                        model.deforming.insert(model.meshes.len(), Arc::new(nodes));
                    }
                    let shown = out.entry(mesh_use).or_default();
                    shown.push((model.meshes.len(), number));
                    model.meshes.push(mesh);
                }
            }
            Err(fault) => faults.add(fault, || reader.place(&mesh_use, p)),
        }
    }
    if faults.is_empty() {
        Ok(out)
    } else {
        Err(faults.into_all())
    }
}

/// Errors of all primitives; equal ones are merged, with the place of the first.
#[derive(Default)]
struct Faults {
    /// Each error with the number of further places that have it.
    list: Vec<(Fault, usize)>,
    /// Index into `list` by name and message of the error.
    known: HashMap<(&'static str, String), usize>,
}

impl Faults {
    fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    fn add(&mut self, fault: Fault, place: impl FnOnce() -> String) {
        let next = self.list.len();
        match self.known.entry((fault.name, fault.message.clone())) {
            Entry::Occupied(entry) => self.list[*entry.get()].1 += 1,
            Entry::Vacant(entry) => {
                entry.insert(next);
                self.list.push((fault.placed(&place()), 0));
            }
        }
    }

    /// Counts one more place of the last error.
    fn repeat_last(&mut self) {
        if let Some((_, more)) = self.list.last_mut() {
            *more += 1;
        }
    }

    fn into_all(self) -> Vec<Fault> {
        let told = |(mut fault, more): (Fault, usize)| {
            match more {
                0 => {}
                1 => fault.message += ", and in 1 more place",
                more => fault.message += &format!(", and in {more} more places"),
            }
            fault
        };
        self.list.into_iter().map(told).collect()
    }
}

/// Unlit copies of materials, for points and lines without normals, by the index of the original material.
#[derive(Default)]
struct UnlitMaterials(HashMap<usize, usize>);

impl UnlitMaterials {
    fn index_of(&mut self, model: &mut Model, lit: usize) -> usize {
        *self.0.entry(lit).or_insert_with(|| {
            model.materials.push(model.materials[lit].without_light());
            model.uv_sets.push(model.uv_sets[lit]);
            model.materials.len() - 1
        })
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
