//! Numbers of materials over time: of those that the scene names, whose values at rest are known
//! here, and of those inside files, whose are not.

use std::collections::HashSet;

use glam::Vec3;

use super::track::Track;
use crate::scene::desc::{
    InstanceDesc, InstanceMaterialDesc, MATERIAL, MATERIAL_FIELDS, MaterialDesc, PLAIN, SceneDesc,
};

/// A material inside a model's file, or all of them as `"*"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileMaterial<'a> {
    /// Name of the `[model.NAME]`.
    pub model: &'a str,
    /// Name of the material.
    pub material: &'a str,
}

/// Every material inside a file that may change: those with motion, and, for a script, those with
/// a table `[model.NAME.material.M]`.
pub fn file_materials(desc: &SceneDesc) -> Vec<FileMaterial<'_>> {
    let mut found = Vec::new();
    let mut add = |model, material| {
        let new = FileMaterial { model, material };
        if !found.contains(&new) {
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

/// For each instance whether its own `material = { … }` may change: for those with tracks for it,
/// and, for a script, for those with a name.
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

/// What an instance's own `material = { … }` says.
pub fn override_of(instance: &InstanceDesc) -> Option<&MaterialDesc> {
    match instance.material.as_ref()? {
        InstanceMaterialDesc::Override(own) => Some(own),
        InstanceMaterialDesc::Named(_) => None,
    }
}

/// What the scene's tables say at rest of a material inside a file: of `"*"`, what they say of
/// any.
pub fn written(desc: &SceneDesc, of: &FileMaterial) -> MaterialDesc {
    let model = desc.models.iter().find(|m| m.name == of.model);
    let tables = model.into_iter().flat_map(|m| &m.value.overrides);
    let meant = tables.filter(|e| of.material == "*" || e.name == "*" || e.name == of.material);
    meant.fold(MaterialDesc::default(), |all, e| all.overlaid(&e.value))
}

/// Values of [`MATERIAL`], where there are any.
pub type Values = [Option<Vec3>; MATERIAL_FIELDS];

/// What changes of a material whose values at rest only its file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialChange {
    /// Values in place of its own.
    pub set: Values,
    /// What is then added to them.
    pub add: Values,
}

/// Poses a `[material.NAME]`.
pub fn pose(material: &mut MaterialDesc, tracks: &[(usize, Track)], time_s: f64) {
    *material = change(tracks, time_s).over(material, &PLAIN);
}

/// What the tracks make of a material at a time, seconds.
pub fn change(tracks: &[(usize, Track)], time_s: f64) -> MaterialChange {
    let mut change = MaterialChange::default();
    for (field, track) in tracks {
        let values = if track.is_absolute() {
            &mut change.set
        } else {
            &mut change.add
        };
        values[*field] = Some(track.at(time_s, Vec3::ZERO, &[]));
    }
    change
}

impl MaterialChange {
    /// `desc` after the change; `rest` says what `desc` leaves open. What goes beyond a number's
    /// range is cut off there.
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

    /// Sets values from now on, whatever was added to them before.
    pub fn put(&mut self, values: &Values) {
        for (i, value) in values.iter().enumerate().filter(|(_, v)| v.is_some()) {
            (self.set[i], self.add[i]) = (*value, None);
        }
    }
}
