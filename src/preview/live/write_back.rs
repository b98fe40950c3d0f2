//! Edits that are written into the scene's texts; the reload after the save shows them in the
//! picture.

use std::{slice::from_ref, sync::Arc};

use super::{Live, Reload};
use crate::write_back::{
    FlightPoint, Inspected, KeyEdit, KeyTrack, Layered, MaterialOrigin, Numbers, SceneItem, change,
    change_flight, change_keys, change_material, change_parameters, inspect, key_tracks, put,
    reduced,
};
use reflet_render::runtime::{model_viewer_scene::is_bare, parameters::ParameterOverrides};
use reflet_scene::stages::Scene;

impl Live {
    /// The description, with the overrides laid over its texts.
    fn layered(&self) -> Layered<'_> {
        Layered::of(&self.session)
    }

    /// Number of times that an edit was written into a text, undone or redone.
    pub fn writes(&self) -> u64 {
        self.history.writes()
    }

    /// Writes a number of a material into the text that says it; `shown` as for [`MaterialOrigin::of`]. Returns the
    /// name of the table.
    ///
    /// # Errors
    /// Sentence with the reason; then no file has changed.
    pub fn write_material(
        &mut self,
        material: usize,
        shown: Option<usize>,
        numbers: &Numbers,
    ) -> Result<String, String> {
        self.check_text()?;
        let origin = MaterialOrigin::of(self.world(), self.desc(), material, shown);
        let origin = origin.ok_or("its shape names no material; write `material = …` there")?;
        let changed = change_material(&self.layered(), &origin, numbers)?;
        self.history.write(changed)?;
        Ok(origin.label(self.desc()))
    }

    /// Writes values of parameters into the texts that declare them.
    ///
    /// # Errors
    /// Sentence with the reason; texts before that one are written.
    pub fn write_parameters(&mut self, values: &ParameterOverrides) -> Result<(), String> {
        self.check_text()?;
        let all = self.declared().iter();
        let changed = all.filter_map(|(name, own)| {
            let value = values.get(name).filter(|value| *value != own)?;
            Some((name.as_str(), value))
        });
        let changed: Vec<_> = changed.collect();
        for change in change_parameters(&self.layered(), &changed)? {
            self.history.write(change)?;
        }
        Ok(())
    }

    /// Tracks of the shown scene that have keys.
    pub fn key_tracks(&self) -> Vec<KeyTrack> {
        key_tracks(self.desc())
    }

    /// Writes a change of the keys of a track into the text that has them.
    ///
    /// # Errors
    /// Sentence with the reason; then no file has changed.
    pub fn edit_key(&mut self, edit: &KeyEdit) -> Result<(), String> {
        self.check_text()?;
        let changed = change_keys(&self.layered(), edit)?;
        self.history.write(changed)
    }

    /// Writes a flight of a camera as keys of its tracks; returns their number. Points that the others give within a
    /// fiftieth of U are left out.
    ///
    /// # Errors
    /// Same errors as [`Live::edit_key`].
    pub fn write_flight(&mut self, camera: &str, points: &[FlightPoint]) -> Result<usize, String> {
        self.check_text()?;
        let points = reduced(points, self.renderer().unit_m() / 50.0);
        let changed = change_flight(&self.layered(), camera, &points)?;
        self.history.write(changed)?;
        Ok(points.len())
    }

    /// Editable numbers of an item.
    pub fn inspect(&self, item: SceneItem) -> Option<Inspected> {
        let mut inspected = inspect(&self.layered(), item)?;
        if let Err(why) = self.check_text() {
            inspected.numbers.clear();
            inspected.refused = Some(why);
        }
        Some(inspected)
    }

    /// Writes numbers of an item into the text that contains them.
    ///
    /// # Errors
    /// Sentence with the reason; then no file has changed.
    pub fn write(&mut self, item: SceneItem, numbers: &Numbers) -> Result<(), String> {
        self.check_text()?;
        let changed = change(&self.layered(), item, from_ref(numbers))?;
        let mut changed = changed.into_iter();
        changed.try_for_each(|changed| self.history.write(changed))
    }

    /// Shows an item with other numbers during a drag: no text changes, and the next reload shows the written
    /// numbers again. Nothing happens while the scene on disk has errors or waits for a frame that can be posed.
    pub fn drag(&mut self, item: SceneItem, numbers: &Numbers) -> Reload {
        let is_shown = self.problems.scene.is_empty() && self.pending.scene().is_none();
        if self.check_text().is_err() || !is_shown {
            return Reload::default();
        }
        let written = self.undragged.take();
        let written = written.unwrap_or_else(|| Arc::clone(&self.session.scene().scene));
        let mut scene = Scene::clone(&self.session.scene().scene);
        put(&mut scene.desc, item, numbers);
        let reload = self.show_numbers(Arc::new(scene));
        self.undragged = Some(written);
        reload
    }

    /// Shows the scene on disk again after a drag; returns whether the drag had changed the picture.
    pub fn drop_drag(&mut self) -> bool {
        let written = self.undragged.take();
        written.is_some_and(|scene| self.show_numbers(scene).ok)
    }

    /// Shows a scene that has other numbers than the shown one.
    fn show_numbers(&mut self, scene: Arc<Scene>) -> Reload {
        let read = self.session.with_numbers(scene);
        self.measured(|live, reload| live.show_changed(read, reload))
    }

    /// Undoes the last written edit, or redoes the last undone one; returns a message about it.
    ///
    /// # Errors
    /// Same errors as [`Live::write`].
    pub fn undo(&mut self, again: bool) -> Result<String, String> {
        let (path, done, nothing) = match again {
            false => (self.history.undo(false)?, "undid a change", "undo"),
            true => (self.history.undo(true)?, "redid a change", "redo"),
        };
        Ok(match path {
            Some(path) => format!("{done} in {}", path.display()),
            None => format!("there is nothing to {nothing}"),
        })
    }

    /// Refuses the built-in scene and lone models, which have no scene text.
    fn check_text(&self) -> Result<(), String> {
        match &self.source().path {
            None => Err("the built-in scene has no file".to_owned()),
            Some(path) if is_bare(path) => {
                Err("a file alone has no scene text to change".to_owned())
            }
            Some(_) => Ok(()),
        }
    }
}
