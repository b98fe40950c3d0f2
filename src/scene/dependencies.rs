//! List of the files that were read or looked for, so that they can be watched for changes.

use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};

/// Paths of all files that were read or looked for, as they were named: links are not resolved, and the
/// files need not exist. Clones share one list.
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

    /// Paths of all files that were looked for so far.
    pub fn paths(&self) -> Vec<PathBuf> {
        let paths = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        paths.clone()
    }
}
