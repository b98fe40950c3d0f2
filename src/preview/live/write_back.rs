//! Edits that are written into the scene's texts; the reload after the save shows them in the
//! picture.

use std::sync::Arc;

use super::{Live, Reload};
use crate::write_back::{Inspected, Numbers, SceneItem, change, inspect, put};
use reflet_render::runtime::model_viewer_scene::is_model;
use reflet_scene::stages::Scene;

impl Live {
    /// Item of the scene text that places an instance of the world, if there is one.
    pub fn item_of(&self, instance: usize) -> Option<SceneItem> {
        let written = self.world().written.get(instance).copied().flatten();
        written.map(SceneItem::Instance)
    }

    /// Editable numbers of an item.
    pub fn inspect(&self, item: SceneItem) -> Option<Inspected> {
        let mut inspected = inspect(self.desc(), item)?;
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
        let variants = &self.source().options.variant;
        let changed = change(self.desc(), variants, item, numbers)?;
        self.history.write(changed)
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
            false => (self.history.undo()?, "undid a change", "undo"),
            true => (self.history.redo()?, "redid a change", "redo"),
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
            Some(path) if is_model(path) => {
                Err("a model alone has no scene text to change".to_owned())
            }
            Some(_) => Ok(()),
        }
    }
}
