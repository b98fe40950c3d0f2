//! Changes that are written into the scene's texts; the files' own saves then bring them into the
//! picture.

use super::Live;
use crate::{
    app::write_back::{Inspected, Numbers, Thing, change, inspect},
    session::model_viewer_scene::is_model,
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
