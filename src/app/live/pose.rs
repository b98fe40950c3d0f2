//! Another frame of the shown scene, and edits of its materials that are not on disk.

use super::Live;
use crate::{
    render::{RebuildSummary, RenderError},
    scene::{
        desc::MaterialDesc,
        diagnostic::Diagnostic,
        motion::{FrameState, Values, number::MATERIAL},
    },
    world::World,
};

/// A change of a material until the scene is next saved; it wins over motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edit {
    /// Index of the material.
    pub material: usize,
    /// Of each field of [`MATERIAL`]: what it is set to. Emission and its strength are set
    /// together, for a material keeps only their product.
    pub values: Values,
}

impl Edit {
    /// Of nothing yet.
    pub fn new(material: usize) -> Self {
        Self {
            material,
            values: Values::default(),
        }
    }

    /// What it makes of a material.
    pub fn over(&self, desc: &MaterialDesc) -> MaterialDesc {
        let mut desc = desc.clone();
        for (field, value) in MATERIAL.iter().zip(self.values) {
            if let Some(value) = value {
                field.put_clamped(&mut desc, value);
            }
        }
        desc
    }

    fn put(&self, world: &mut World) {
        let material = &mut world.materials[self.material];
        let desc = MaterialDesc {
            checker: material.checker, // of which some numbers may be set
            ..MaterialDesc::default()
        };
        material.set_numbers(&self.over(&desc));
    }
}

impl Live {
    /// Shows a posed frame: poses, the top level over them and the numbers of materials are uploaded,
    /// nothing else is done again.
    pub(super) fn apply(&mut self, state: Option<FrameState>) -> Result<(), Vec<Diagnostic>> {
        if let Some(state) = state {
            self.world.apply(&state)?;
            for edit in &self.edits {
                edit.put(&mut self.world);
            }
            (self.renderer.update(&self.gpu, &self.world))
                .map_err(RenderError::into_diagnostics)?;
            self.log = state.log;
        }
        self.posed = self.frame;
        Ok(())
    }

    /// What of a material is changed now.
    pub fn edit_of(&self, material: usize) -> Edit {
        let known = self.edits.iter().find(|edit| edit.material == material);
        known.copied().unwrap_or_else(|| Edit::new(material))
    }

    /// Changes a material until the scene is next saved.
    ///
    /// # Errors
    /// As [`crate::render::Renderer::change`]; then nothing has changed.
    pub fn edit(&mut self, edit: Edit) -> Result<RebuildSummary, RenderError> {
        if edit.material >= self.world.materials.len() {
            return Ok(RebuildSummary::default()); // of a scene that is gone
        }
        let materials = self.world.materials.clone();
        edit.put(&mut self.world);
        let options = *self.renderer.options();
        let (library, world) = (&self.library, &self.world);
        let done = (self.renderer).change(&self.gpu, library, world, &options);
        if done.is_err() {
            self.world.materials = materials;
        } else {
            self.edits.retain(|known| known.material != edit.material);
            self.edits.push(edit);
        }
        done
    }
}
