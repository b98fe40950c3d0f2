//! Posing of other frames, and material edits that are not on disk.

use super::Live;
use reflet_render::{RebuildSummary, RenderError};
use reflet_scene::{
    desc::{MATERIAL, MaterialDesc},
    diagnostic::Diagnostic,
    motion::{FrameState, NO_VALUES, Values},
};
use reflet_world::World;

/// A material edit that lasts until the scene is saved; it overrides motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edit {
    /// Index of the material.
    pub material: usize,
    /// Value of each field of [`MATERIAL`], if set. Emission and its strength are set together,
    /// since a material stores only their product.
    pub values: Values,
}

impl Edit {
    /// An edit without values.
    pub fn new(material: usize) -> Self {
        Self {
            material,
            values: NO_VALUES,
        }
    }

    /// The material with the edit applied.
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
            checker: material.checker, // has editable numbers
            ..MaterialDesc::default()
        };
        material.set_numbers(&self.over(&desc));
    }
}

/// Applies edits to a posed world.
pub(super) fn put_all(edits: &[Edit], world: &mut World) {
    edits.iter().for_each(|edit| edit.put(world));
}

impl Live {
    /// Shows a posed frame: uploads poses, the top-level tree and material numbers only.
    pub(super) fn apply(
        &mut self,
        frame: u32,
        pose: Option<FrameState>,
    ) -> Result<(), Vec<Diagnostic>> {
        let edits = &self.edits;
        (self.session).apply(frame, pose, &|world| put_all(edits, world))
    }

    /// Cuts: first frame and camera index of each; empty without cuts.
    pub fn cuts(&self) -> Vec<(u32, usize)> {
        let cuts = &self.desc().cuts;
        if cuts.is_empty() {
            return Vec::new();
        }
        let cameras = &self.world().cameras;
        let index = |name: &str| cameras.iter().position(|camera| camera.name == name);
        let named = cuts.iter();
        let named = named.filter_map(|cut| Some((cut.frame, index(&cut.camera.value)?)));
        std::iter::once((0, self.world().main_camera()))
            .chain(named)
            .collect()
    }

    /// The current edit of a material.
    pub fn edit_of(&self, material: usize) -> Edit {
        let known = self.edits.iter().find(|edit| edit.material == material);
        known.copied().unwrap_or_else(|| Edit::new(material))
    }

    /// Edits a material until the scene is saved.
    ///
    /// # Errors
    /// Same errors as [`reflet_render::Renderer::change`]; then nothing changes.
    pub fn edit(&mut self, edit: Edit) -> Result<RebuildSummary, RenderError> {
        if edit.material >= self.world().materials.len() {
            return Ok(RebuildSummary::default()); // the edit belongs to a replaced scene
        }
        let rebuilt = self.session.edit(&|world| edit.put(world))?;
        self.edits.retain(|known| known.material != edit.material);
        self.edits.push(edit);
        Ok(rebuilt)
    }
}
