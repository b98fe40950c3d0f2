//! Which material a placement has: the model's or the file's, after all overrides.

use super::{
    Loader,
    material::merged,
    place::{Job, MaterialKey},
};
use crate::{
    scene::desc::{At, InstanceMaterialDesc, MaterialDesc, ModelDesc},
    world::{Material, pose::MovingMaterial},
};

impl Loader<'_> {
    pub fn shape_material(&mut self, job: &Job<'_>, model: &ModelDesc) -> usize {
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

    pub fn instance_material(&mut self, job: &Job<'_>, loaded: usize, index: usize) -> usize {
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
