//! Which files were read or looked for, so that they can be watched.

use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

/// Every file that was read or looked for, as it was named: links are not followed, and it need not
/// exist. Clones share one list.
#[derive(Clone, Debug, Default)]
pub struct Dependencies(Arc<Mutex<Vec<PathBuf>>>);

impl Dependencies {
    /// Adds a file, once.
    pub fn add(&self, path: PathBuf) {
        let mut paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !paths.contains(&path) {
            paths.push(path);
        }
    }

    /// What was looked at so far.
    pub fn paths(&self) -> Vec<PathBuf> {
        let paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        paths.clone()
    }
}
