//! Changed values of a material.

use glam::Vec3;

use super::{protocol::Task, scene_summary::MaterialRow};
use crate::{
    live::Edit,
    write_back::{Numbers, numbers_of},
};
use reflet_scene::{
    desc::{MATERIAL, MaterialDesc},
    number::Field,
};

/// Fields that are changed together, since a material keeps only their product.
const PAIR: [&str; 2] = ["emission", "emission_strength"];

impl MaterialRow {
    /// Numbers that the material has now: the index of each into [`MATERIAL`], its field and its value.
    pub fn fields(&self) -> impl Iterator<Item = (usize, &'static Field<MaterialDesc>, Vec3)> {
        let now = self.edit.over(&self.numbers);
        let fields = MATERIAL.iter().enumerate();
        fields.filter_map(move |(index, field)| Some((index, field, (field.get)(&now)?)))
    }

    /// Sentence that tells where its numbers are written.
    pub fn told(&self) -> String {
        match &self.origin {
            Some(table) => format!("written into {table} where a change ends"),
            None => "shown until the scene is saved: no table names this material".to_owned(),
        }
    }

    /// The task that writes the edited value of a field of [`MATERIAL`], by its index, into the scene text; `None`
    /// where it is not edited.
    pub fn to_write(edit: &Edit, field: usize) -> Option<Task> {
        let (value, field) = (edit.values[field]?, &MATERIAL[field]);
        let numbers = Numbers {
            key: field.key,
            values: numbers_of(field.form, value),
        };
        Some(Task::WriteMaterial(edit.material, numbers))
    }

    /// The edit after the value of a field of [`MATERIAL`], by its index, is changed, or is the scene's again where there
    /// is none. Emission and its strength are set together, since a material keeps only their product.
    pub fn with(&self, edit: &Edit, field: usize, value: Option<Vec3>) -> Edit {
        let now = self.edit.over(&self.numbers);
        let mut edit = *edit;
        let is_paired = PAIR.contains(&MATERIAL[field].key);
        for (other, of) in MATERIAL.iter().enumerate() {
            if other == field {
                edit.values[other] = value;
            } else if is_paired && PAIR.contains(&of.key) {
                edit.values[other] = value.and_then(|_| (of.get)(&now));
            }
        }
        edit
    }
}
