//! Instances: which mesh stands where with which material, from scene text and file nodes.

use glam::Affine3A;

use super::{
    Loader, Source,
    copies::{Copy, copies, invertible},
    did_you_mean, error_at,
    extras::Extras,
    material::merged,
};
use crate::{
    scene::{
        desc::{At, InstanceDesc, InstanceMaterialDesc, MaterialDesc, ModelDesc, SceneDesc},
        diagnostic::{Diagnostic, Severity, Span},
        motion::moving,
    },
    world::{
        Instance, Material,
        pose::{MovingInstance, MovingMaterial},
    },
};

/// A mesh of a loaded file.
pub type MeshKey = (usize, usize);

/// Model of the scene, material of its file, and the instance if that changes the material.
pub type MaterialKey = (usize, usize, Option<usize>);

/// Most instances of a scene.
const MAX_INSTANCES: usize = 1 << 20;

/// One model placed once or on a grid.
struct Job<'a> {
    model: usize,
    /// Index of the `[[instance]]`; `None` for a model that no instance names.
    index: Option<usize>,
    instance: Option<&'a InstanceDesc>,
    at: &'a Span,
    /// Whether it may move.
    dynamic: bool,
}

/// Every `[[instance]]`, then the models that none of them names.
fn jobs(desc: &SceneDesc) -> Vec<Job<'_>> {
    let mut named = vec![false; desc.models.len()];
    let mut jobs = Vec::new();
    let dynamic = moving(desc);
    for (index, instance) in desc.instances.iter().enumerate() {
        let name = &instance.model.value;
        // A name without a model was reported before.
        if let Some(model) = desc.models.iter().position(|m| m.name == *name) {
            named[model] = true;
            jobs.push(Job {
                model,
                index: Some(index),
                instance: Some(instance),
                at: &instance.at,
                dynamic: dynamic[index],
            });
        }
    }
    let alone = desc
        .models
        .iter()
        .enumerate()
        .filter(|(model, _)| !named[*model]);
    jobs.extend(alone.map(|(model, entry)| Job {
        model,
        index: None,
        instance: None,
        at: &entry.at,
        dynamic: false,
    }));
    jobs
}

impl Loader<'_> {
    /// Reports names that point nowhere.
    pub fn check_names(&mut self, sources: &[Source]) {
        let desc = self.desc;
        for instance in &desc.instances {
            let name = &instance.model;
            if !desc.models.iter().any(|m| m.name == name.value) {
                let text = format!("model \"{}\" is not defined", name.value);
                let mut error = error_at("unknown-name", &name.at, text);
                error.help = did_you_mean(&name.value, desc.models.iter().map(|m| m.name.as_str()))
                    .or_else(|| Some(format!("add a table [model.{}]", name.value)));
                self.errors.push(error);
            }
        }
        for (model, source) in desc.models.iter().zip(sources) {
            let Source::File(loaded) = source else {
                continue;
            };
            let known = &self.loaded[*loaded].materials;
            for entry in model.value.overrides.iter().filter(|e| e.name != "*") {
                if !known.iter().any(|m| m.name == entry.name) {
                    let file = self.loaded[*loaded].files[0].display();
                    let text = format!("\"{file}\" has no material \"{}\"", entry.name);
                    let mut error = error_at("unknown-material", &entry.at, text);
                    error.help = did_you_mean(&entry.name, known.iter().map(|m| m.name.as_str()))
                        .or_else(|| Some(list_names(known)));
                    self.errors.push(error);
                }
            }
        }
    }

    /// Fills the world's instances, lights and cameras.
    pub fn place_all(&mut self, sources: &[Source]) {
        let mut extras = Extras::new(self.desc);
        for job in &jobs(self.desc) {
            let before = self.world.instances.len();
            let mut dropped = Vec::new();
            self.place(job, &sources[job.model], &mut extras, &mut dropped);
            let placed = self.world.instances.len();
            if placed > MAX_INSTANCES {
                let text = format!("more than {MAX_INSTANCES} instances");
                self.errors
                    .push(error_at("instances-too-many", job.at, text));
                return;
            }
            self.warn_of_dropped(job, &dropped, placed - before);
        }
        self.finish_extras(extras);
    }

    fn warn_of_dropped(&mut self, job: &Job<'_>, dropped: &[String], kept: usize) {
        let Some(first) = dropped.first() else {
            return;
        };
        let text = format!(
            "{} of {} placements have a transform that is singular or not finite and are dropped; \
             first: {first}",
            dropped.len(),
            dropped.len() + kept
        );
        self.world.warnings.push(Diagnostic {
            severity: Severity::Warning,
            ..error_at("instance-singular", job.at, text)
        });
    }

    fn place(
        &mut self,
        job: &Job<'_>,
        source: &Source,
        extras: &mut Extras,
        dropped: &mut Vec<String>,
    ) {
        let model = &self.desc.models[job.model];
        let base_name = (job.instance.and_then(|i| i.name.as_ref())).unwrap_or(&model.name);
        for (number, copy) in copies(job.instance).enumerate() {
            let name = format!("{base_name}{}", copy.suffix);
            match source {
                Source::Broken => return,
                Source::Shape(mesh) => {
                    let look = (*mesh, self.shape_material(job, &model.value));
                    self.push(job, name, look, &copy, Affine3A::IDENTITY, dropped);
                }
                Source::File(loaded) => {
                    self.place_file(job, *loaded, &name, &copy, dropped);
                    let model_data = &self.loaded[*loaded];
                    extras.add(model, model_data, &name, copy.world_from_model, number == 0);
                }
            }
            if self.world.instances.len() > MAX_INSTANCES {
                return;
            }
        }
    }

    fn place_file(
        &mut self,
        job: &Job<'_>,
        loaded: usize,
        name: &str,
        copy: &Copy,
        dropped: &mut Vec<String>,
    ) {
        for i in 0..self.loaded[loaded].placements.len() {
            let placement = self.loaded[loaded].placements[i].clone();
            let mesh = self.file_mesh(loaded, placement.mesh);
            let look = (
                mesh,
                self.instance_material(job, loaded, placement.material),
            );
            let name = format!("{name}/{}", placement.name);
            self.push(job, name, look, copy, placement.model_from_object, dropped);
            if self.world.instances.len() > MAX_INSTANCES {
                return;
            }
        }
    }

    /// Adds an instance; `look` is its mesh and its material.
    fn push(
        &mut self,
        job: &Job<'_>,
        name: String,
        (mesh, material): (usize, usize),
        copy: &Copy,
        model_from_object: Affine3A,
        dropped: &mut Vec<String>,
    ) {
        let world_from_object = copy.world_from_model * model_from_object;
        let bounds = self.world.meshes[mesh]
            .bounds
            .transformed(&world_from_object);
        let finite = bounds.is_empty() || bounds.min.is_finite() && bounds.max.is_finite();
        if !finite || !invertible(&world_from_object) {
            dropped.push(name);
            return;
        }
        if let (true, Some(desc)) = (job.dynamic, job.index) {
            self.world.moving.instances.push(MovingInstance {
                desc,
                instance: self.world.instances.len(),
                offset: copy.offset,
                model_from_object,
                mirrored: world_from_object.matrix3.determinant() < 0.0,
            });
        }
        self.world.instances.push(Instance {
            name,
            mesh,
            material,
            world_from_object,
            dynamic: job.dynamic,
        });
    }

    /// The world's mesh for a file's mesh: moved there when first placed, shared afterwards.
    fn file_mesh(&mut self, loaded: usize, mesh: usize) -> usize {
        *self.meshes.entry((loaded, mesh)).or_insert_with(|| {
            self.world
                .meshes
                .push(std::mem::take(&mut self.loaded[loaded].meshes[mesh]));
            self.world.meshes.len() - 1
        })
    }

    fn shape_material(&mut self, job: &Job<'_>, model: &ModelDesc) -> usize {
        let changed = job
            .index
            .filter(|_| job.instance.is_some_and(|i| i.material.is_some()));
        let key = (job.model, 0, changed);
        if let Some(&index) = self.materials.get(&key) {
            return index;
        }
        let base = Material {
            name: "default".into(),
            double_sided: true,
            ..Material::default()
        };
        let mut name = model.material.as_ref();
        let mut over = MaterialDesc::default();
        match job.instance.and_then(|i| i.material.as_ref()) {
            Some(InstanceMaterialDesc::Named(own)) => name = Some(own),
            Some(InstanceMaterialDesc::Override(desc)) => over.clone_from(desc),
            None => {}
        }
        let mut material = match name {
            Some(name) => self.named_material(name, base),
            None => base,
        };
        self.apply(&over, &mut material);
        self.add_moving_material(key, name, over, material)
    }

    fn instance_material(&mut self, job: &Job<'_>, loaded: usize, index: usize) -> usize {
        let changed = job
            .index
            .filter(|_| job.instance.is_some_and(|i| i.material.is_some()));
        let key = (job.model, index, changed);
        if let Some(&index) = self.materials.get(&key) {
            return index;
        }
        let own = &self.loaded[loaded].materials[index];
        let over = job.instance.and_then(|i| i.material.as_ref());
        if let Some(InstanceMaterialDesc::Named(name)) = over {
            let base = Material {
                double_sided: own.double_sided,
                ..Material::default()
            };
            let material = self.named_material(name, base);
            return self.add_moving_material(key, Some(name), MaterialDesc::default(), material);
        }
        // "*" first, then by name, then the instance: merged before they are applied, so that
        // factors such as uv_scale act once.
        let overrides = &self.desc.models[job.model].value.overrides;
        let mut desc = MaterialDesc::default();
        for name in ["*", own.name.as_str()] {
            for layer in overrides.iter().filter(|e| e.name == name) {
                desc = merged(&desc, &layer.value);
            }
        }
        if let Some(InstanceMaterialDesc::Override(layer)) = over {
            desc = merged(&desc, layer);
        }
        let material = self.file_material(loaded, index, &desc);
        self.add_material(key, material)
    }

    /// A material that comes from a `[material.NAME]`: if that may change, it is stored apart from
    /// those that are equal to it now.
    fn add_moving_material(
        &mut self,
        key: MaterialKey,
        name: Option<&At<String>>,
        over: MaterialDesc,
        material: Material,
    ) -> usize {
        let desc = self.desc;
        let by_script = desc.script.as_ref().is_some_and(|s| s.has_frame());
        let moves = |name: &str| by_script || desc.motion.materials.iter().any(|m| m.name == name);
        let found = name.filter(|name| moves(&name.value));
        let found = found.and_then(|n| desc.materials.iter().position(|m| m.name == n.value));
        let Some(entry) = found else {
            return self.add_material(key, material);
        };
        let of_entry = |m: &&MovingMaterial| m.desc == entry && m.over == over;
        let mut known = self.world.moving.materials.iter().filter(of_entry);
        let same = known.find(|m| m.rest == material);
        let index = same.map_or(self.world.materials.len(), |m| m.material);
        if index == self.world.materials.len() {
            self.world.moving.materials.push(MovingMaterial {
                desc: entry,
                material: index,
                over,
                rest: material.clone(),
            });
            self.world.materials.push(material);
        }
        self.materials.insert(key, index);
        index
    }

    /// Equal materials are stored once.
    fn add_material(&mut self, key: MaterialKey, material: Material) -> usize {
        let same = self
            .materials_by_name
            .entry(material.name.clone())
            .or_default();
        let known = same
            .iter()
            .copied()
            .find(|&i| self.world.materials[i] == material);
        let index = known.unwrap_or_else(|| {
            same.push(self.world.materials.len());
            self.world.materials.push(material);
            self.world.materials.len() - 1
        });
        self.materials.insert(key, index);
        index
    }
}

fn list_names(materials: &[Material]) -> String {
    const MOST: usize = 30;
    let names = materials.iter().rev().skip(1).rev(); // the default one is last and cannot be named
    let mut names: Vec<_> = names.map(|m| m.name.as_str()).collect();
    let more = if names.len() > MOST { ", …" } else { "" };
    names.truncate(MOST);
    format!("its materials are {}{more}", names.join(", "))
}
