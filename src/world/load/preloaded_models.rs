//! Models that were read before the scene around them was written, so that they are not read again.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use super::read_guarded;
use crate::world::gltf::{Model, Playable, Sandbox};

/// Models by their canonical path; clones share them.
#[derive(Clone, Debug, Default)]
pub struct PreloadedModels(Arc<Mutex<Vec<(PathBuf, Model)>>>);

impl PreloadedModels {
    /// Reads the file at `path` (canonical, from [`Sandbox::resolve`]) and keeps it for the next
    /// load; gives what it can play. Of a file that is wrong nothing is kept: loading it says why.
    pub fn read(&self, path: &Path, sandbox: &Sandbox) -> Playable {
        let Ok(model) = read_guarded(path, sandbox) else {
            return Playable::default();
        };
        let playable = model.playable();
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push((path.to_owned(), model));
        playable
    }

    /// Gives what was read.
    pub(super) fn take(&self, path: &Path) -> Option<Model> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = kept.iter().position(|(known, _)| known == path)?;
        Some(kept.swap_remove(found).1)
    }
}
