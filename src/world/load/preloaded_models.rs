//! Cache of models that were read to generate their scene text, so that loading reuses them.

use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

use super::read_models::read_guarded;
use crate::gltf::{Model, Playable, ReadOptions, Sandbox};
use reflet_base::memory::Budget;

/// Mistakes of files that a load forgives, see [`ReadOptions`].
#[derive(Clone, Copy, Debug)]
pub struct Forgiven {
    /// Whether it ignores what a file requires, and drops wrong references to nodes and meshes.
    pub lenient: bool,
    /// Whether it leaves out nothing.
    pub strict: bool,
}

/// A model with its canonical path and the budget that it was read with.
type Preloaded = (PathBuf, Model, Budget);

/// Models by their canonical path; clones share them.
#[derive(Clone, Debug, Default)]
pub struct PreloadedModels(Arc<Mutex<Vec<Preloaded>>>);

impl PreloadedModels {
    /// Reads the file at `path` (canonical, from [`Sandbox::resolve`]) and caches it for the next
    /// load; returns its animations. Invalid files are not cached; the load reports their errors.
    pub fn read(&self, path: &Path, sandbox: &Sandbox, forgiven: Forgiven) -> Playable {
        let options = ReadOptions {
            lenient: forgiven.lenient,
            strict: forgiven.strict,
            memory: Budget::of_machine(),
            ..ReadOptions::default()
        };
        let Ok(model) = read_guarded(path, sandbox, &options) else {
            return Playable::default();
        };
        let playable = model.playable();
        let mut models = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        models.push((path.to_owned(), model, options.memory));
        playable
    }

    /// Takes a cached model, with the rest of the budget that it was read with.
    pub(super) fn take(&self, path: &Path) -> Option<(Model, Budget)> {
        let mut models = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = models.iter().position(|(known, ..)| known == path)?;
        let (_, model, memory) = models.swap_remove(found);
        Some((model, memory))
    }
}
