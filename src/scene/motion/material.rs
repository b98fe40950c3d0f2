//! Material numbers over time: of the scene's materials, whose values at rest are known here, and of
//! materials inside files, whose values are not.

use std::collections::HashSet;

use glam::Vec3;

use super::track::Track;
use crate::desc::{
    ByName, Entry, InstanceDesc, InstanceMaterialDesc, MATERIAL, MATERIAL_FIELDS, MaterialDesc,
    ModelDesc, PLAIN, SceneDesc,
};

/// A material inside a model's file, or all of them as `"*"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FileMaterial<'a> {
    /// Name of the `[model.NAME]`.
    pub model: &'a str,
    /// Name of the material.
    pub material: &'a str,
}

/// Materials inside files that may change: by motion, or, with a table `[model.NAME.material.M]`, by a script.
pub fn file_materials(desc: &SceneDesc) -> Vec<FileMaterial<'_>> {
    let (mut found, mut known) = (Vec::new(), HashSet::new());
    let mut add = |model, material| {
        let new = FileMaterial { model, material };
        if known.insert(new) {
            found.push(new);
        }
    };
    if desc.has_frame_script() {
        for model in &desc.models {
            (model.value.overrides.iter()).for_each(|e| add(model.name.as_str(), e.name.as_str()));
        }
    }
    for model in &desc.motion.models {
        (model.value.materials.iter()).for_each(|e| add(model.name.as_str(), e.name.as_str()));
    }
    found
}

/// Whether the own `material = { … }` of each instance may change: if it has tracks, or, with a script, if the
/// instance has a name.
pub fn changing_overrides(desc: &SceneDesc) -> Vec<bool> {
    let by_script = desc.has_frame_script();
    let tracks = desc.motion.instances.iter();
    let named: HashSet<_> = tracks
        .filter(|e| e.value.material.is_some())
        .map(|e| e.name.as_str())
        .collect();
    let changes = |i: &InstanceDesc| {
        let name = i.name.as_deref();
        override_of(i).is_some() && name.is_some_and(|name| by_script || named.contains(name))
    };
    desc.instances.iter().map(changes).collect()
}

/// The own `material = { … }` of an instance, if it is a table.
pub fn override_of(instance: &InstanceDesc) -> Option<&MaterialDesc> {
    match instance.material.as_ref()? {
        InstanceMaterialDesc::Override(own) => Some(own),
        InstanceMaterialDesc::Named(_) => None,
    }
}

/// Tables `[model.NAME.material.M]` of one model, by the names of the materials.
pub struct ModelTables<'a> {
    tables: &'a [Entry<MaterialDesc>],
    names: ByName<'a>,
}

impl<'a> ModelTables<'a> {
    /// Tables of a model, if the scene has it.
    pub fn for_model(model: Option<&'a Entry<ModelDesc>>) -> Self {
        let tables = model.map_or(&[][..], |model| &model.value.overrides);
        Self {
            tables,
            names: ByName::from_entries(tables),
        }
    }

    /// Values that the tables give to a material inside the file at rest; for `"*"`, all values that they give to
    /// any material.
    pub fn written(&self, material: &str) -> MaterialDesc {
        let overlay = |all: MaterialDesc, e: &Entry<MaterialDesc>| all.overlaid(&e.value);
        if material == "*" {
            return self.tables.iter().fold(MaterialDesc::default(), overlay);
        }
        let mut meant: Vec<_> = ["*", material]
            .iter()
            .filter_map(|name| self.names.index(name))
            .collect();
        meant.sort_unstable();
        let meant = meant.into_iter().map(|index| &self.tables[index]);
        meant.fold(MaterialDesc::default(), overlay)
    }
}

/// Written values of many file materials, in their order; `models` are the scene's. Materials of one model follow each
/// other.
pub fn written_all(desc: &SceneDesc, models: &ByName, all: &[FileMaterial]) -> Vec<MaterialDesc> {
    let of_one_model = all.chunk_by(|a, b| a.model == b.model);
    let written = of_one_model.flat_map(|same| {
        let model = same.first().and_then(|first| models.index(first.model));
        let tables = ModelTables::for_model(model.map(|index| &desc.models[index]));
        same.iter().map(move |m| tables.written(m.material))
    });
    written.collect()
}

/// Value of each field of [`MATERIAL`], where it is set.
pub type Values = [Option<Vec3>; MATERIAL_FIELDS];

/// Values of a material of which none is set.
pub const NO_VALUES: Values = [None; MATERIAL_FIELDS];

/// Change of a material whose values at rest only its file has.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialChange {
    /// Values in place of the material's own.
    pub set: Values,
    /// Values that are added afterwards.
    pub add: Values,
}

impl Default for MaterialChange {
    fn default() -> Self {
        let (set, add) = (NO_VALUES, NO_VALUES);
        Self { set, add }
    }
}

/// Sets a `[material.NAME]` to its tracks at a time, seconds.
pub fn pose(material: &mut MaterialDesc, tracks: &[(usize, Track)], time_s: f64) {
    *material = change(tracks, time_s).over(material, &PLAIN);
}

/// Change that tracks make to a material at a time, seconds.
pub fn change(tracks: &[(usize, Track)], time_s: f64) -> MaterialChange {
    let mut change = MaterialChange::default();
    for (field, track) in tracks {
        let values = if track.is_absolute() {
            &mut change.set
        } else {
            &mut change.add
        };
        values[*field] = Some(track.value_at(time_s, Vec3::ZERO, None));
    }
    change
}

impl MaterialChange {
    /// Material `desc` after the change; `rest` has the values that `desc` leaves out. Values outside of their
    /// range are clamped.
    pub fn over(&self, desc: &MaterialDesc, rest: &MaterialDesc) -> MaterialDesc {
        let mut changed = desc.clone();
        for (field, (set, add)) in MATERIAL.iter().zip(self.set.iter().zip(&self.add)) {
            if set.is_some() || add.is_some() {
                let value = set
                    .or_else(|| (field.get)(desc))
                    .or_else(|| (field.get)(rest));
                let value = value.unwrap_or(Vec3::ZERO) + add.unwrap_or(Vec3::ZERO);
                field.put_clamped(&mut changed, value);
            }
        }
        changed
    }

    /// Sets values, and drops what was to be added to them.
    pub fn put(&mut self, values: &Values) {
        for (i, value) in values.iter().enumerate().filter(|(_, v)| v.is_some()) {
            (self.set[i], self.add[i]) = (*value, None);
        }
    }
}
