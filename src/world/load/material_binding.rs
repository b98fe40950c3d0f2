//! Material binding of instances: the model's or file's material, after all overrides.

use super::{
    Loader,
    place::{Job, MaterialKey},
};
use crate::{
    Material,
    animation::Pointed,
    pose::{MaterialSource, MovingMaterial},
};
use reflet_scene::{
    desc::{At, InstanceMaterialDesc, MaterialDesc, ModelDesc},
    motion::FileMaterial,
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
        self.add_moving_material(key, name, over, job.over_change, material)
    }

    pub fn instance_material(
        &mut self,
        job: &Job<'_>,
        loaded: usize,
        index: usize,
        player: Option<usize>,
    ) -> usize {
        let players = &self.world.moving.players;
        let player = player.filter(|p| players[*p].changes(Pointed::Material(index)));
        let is_own = player.is_some() || job.instance.is_some_and(|i| i.material.is_some());
        let changed = job.index.filter(|_| is_own);
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
            let over = MaterialDesc::default();
            return self.add_moving_material(key, Some(name), over, None, material);
        }
        // "*" first, then by name, then the instance: merged before they are applied, so that
        // factors such as uv_scale act once.
        let overrides = &self.desc.models[job.model].value.overrides;
        let mut desc = MaterialDesc::default();
        for name in ["*", own.name.as_str()] {
            for layer in overrides.iter().filter(|e| e.name == name) {
                desc = desc.overlaid(&layer.value);
            }
        }
        let over = match over {
            Some(InstanceMaterialDesc::Override(layer)) => (**layer).clone(),
            _ => MaterialDesc::default(),
        };
        let changes = self.changes_of(job.model, &own.name);
        let is_moving = !changes.is_empty() || job.over_change.is_some() || player.is_some();
        let from = is_moving.then(|| MaterialSource::File {
            changes,
            own: own.numbers(),
            overrides: Box::new(desc.clone()),
            player: player.map(|player| (player, index)),
        });
        let material = self.file_material(loaded, index, &desc.overlaid(&over));
        match from {
            Some(from) => self.add_source(key, from, over, job.over_change, material),
            None => self.add_material(key, material),
        }
    }

    /// Animated overrides of a file's material, as indices into `FrameState::file_materials`; overrides of all
    /// materials first.
    fn changes_of<'n>(&'n self, model: usize, material: &'n str) -> Vec<usize> {
        let model = self.desc.models[model].name.as_str();
        let all = &self.file_materials;
        let of = |material| all.get(&FileMaterial { model, material }).copied();
        ["*", material].into_iter().filter_map(of).collect()
    }

    /// Binds a `[material.NAME]`; an animated one is stored apart from equal materials.
    pub fn add_moving_material(
        &mut self,
        key: MaterialKey,
        name: Option<&At<String>>,
        over: MaterialDesc,
        over_change: Option<usize>,
        material: Material,
    ) -> usize {
        let desc = self.desc;
        let by_script = desc.has_frame_script();
        let over_changes = over_change.is_some();
        let moves = |name: &str| over_changes || by_script || self.moved.index(name).is_some();
        let found = name.filter(|name| moves(&name.value));
        let found = found.and_then(|n| self.named_materials.index(&n.value));
        let from = match found {
            Some(entry) => MaterialSource::Named(entry),
            None if over_changes => MaterialSource::Plain,
            None => return self.add_material(key, material),
        };
        self.add_source(key, from, over, over_change, material)
    }

    fn add_source(
        &mut self,
        key: MaterialKey,
        from: MaterialSource,
        over: MaterialDesc,
        over_change: Option<usize>,
        material: Material,
    ) -> usize {
        let alike = |m: &&MovingMaterial| {
            m.from == from && m.over == over && m.over_change.is_none() && m.rest == material
        };
        // Materials animated per instance are not shared.
        let moving = &self.world.moving.materials;
        let same_name = self.moving_by_name.entry(material.name.clone());
        let same_name = same_name.or_default();
        let mut known = same_name.iter().map(|index| &moving[*index]);
        let same = known.find(|m| over_change.is_none() && alike(m));
        let index = same.map_or(self.world.materials.len(), |m| m.material);
        if index == self.world.materials.len() {
            if over_change.is_none() {
                same_name.push(moving.len());
            }
            self.world.moving.materials.push(MovingMaterial {
                from,
                material: index,
                over,
                over_change,
                rest: material.clone(),
            });
            self.world.materials.push(material);
        }
        self.materials.insert(key, index);
        index
    }

    /// Binds a static material; equal ones are stored once.
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
