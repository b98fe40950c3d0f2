//! Changes that are written into the scene's texts; the files' own saves then bring them into the
//! picture.

use std::sync::Arc;

use super::{Live, Reload, reload_job::Read};
use crate::{
    app::write_back::{Inspected, Numbers, Thing, change, inspect, put},
    scene::stages::Scene,
    session::{model_viewer_scene::is_model, scene_text::load_options},
};

impl Live {
    /// What places an instance of the world, if the scene text does.
    pub fn thing_of(&self, instance: usize) -> Option<Thing> {
        let written = self.world.written.get(instance).copied().flatten();
        written.map(Thing::Instance)
    }

    /// What of a thing can be changed.
    pub fn inspect(&self, thing: Thing) -> Option<Inspected> {
        let mut inspected = inspect(&self.scene, thing)?;
        if let Err(why) = self.check_text() {
            inspected.numbers.clear();
            inspected.refused = Some(why);
        }
        Some(inspected)
    }

    /// Writes numbers of a thing into the text in which they stand.
    ///
    /// # Errors
    /// Why that is not possible, as a sentence; no file has changed then.
    pub fn write(&mut self, thing: Thing, numbers: &Numbers) -> Result<(), String> {
        self.check_text()?;
        let variants = &self.source.args.variant;
        self.history
            .write(change(&self.scene, variants, thing, numbers)?)
    }

    /// Shows a thing with other numbers while they are dragged: no text changes, and the next reload shows what
    /// is written again. Nothing happens while the scene on disk has errors.
    pub fn drag(&mut self, thing: Thing, numbers: &Numbers) -> Reload {
        if self.check_text().is_err() || !self.problems.scene.is_empty() {
            return Reload::default();
        }
        let written = self.undragged.take();
        let written = written.unwrap_or_else(|| Arc::clone(&self.scene));
        let mut scene = Scene::clone(&self.scene);
        put(&mut scene.desc, thing, numbers);
        let reload = self.show_numbers(Arc::new(scene));
        self.undragged = Some(written);
        reload
    }

    /// Shows again what is written; returns whether a drag had changed it.
    pub fn drop_drag(&mut self) -> bool {
        let written = self.undragged.take();
        written.is_some_and(|scene| self.show_numbers(scene).ok)
    }

    /// Shows a scene that differs from the shown one by numbers.
    fn show_numbers(&mut self, scene: Arc<Scene>) -> Reload {
        let read = Read {
            scene,
            warnings: Vec::new(),
            declared: self.declared.clone(),
            parameters: self.parameters.clone(),
            frame: self.frame,
            options: load_options(&self.source.args.options(), &self.dependencies),
        };
        let warnings = std::mem::take(&mut self.warnings);
        let reload = self.measured(|live, reload| live.show_changed(read, reload));
        self.warnings = warnings;
        reload
    }

    /// Takes the last written change back, or makes it again; returns what was done.
    ///
    /// # Errors
    /// As [`Live::write`].
    pub fn undo(&mut self, again: bool) -> Result<String, String> {
        let (path, done, nothing) = match again {
            false => (self.history.undo()?, "took a change back", "undo"),
            true => (self.history.redo()?, "made a change again", "redo"),
        };
        Ok(match path {
            Some(path) => format!("{done} in {}", path.display()),
            None => format!("there is nothing to {nothing}"),
        })
    }

    /// Refuses what is shown without scene text of its own.
    fn check_text(&self) -> Result<(), String> {
        match &self.source.path {
            None => Err("the built-in scene has no file".to_owned()),
            Some(path) if is_model(path) => {
                Err("a model alone has no scene text to change".to_owned())
            }
            Some(_) => Ok(()),
        }
    }
}
