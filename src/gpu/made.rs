//! Counts what is costly to make on the device, so that a reload can say what it made again.

use std::sync::atomic::{AtomicU32, Ordering};

/// How many costly things were made so far; a reload is measured by what it adds.
#[derive(Debug, Default)]
pub struct Made {
    pub(super) shaders: AtomicU32,
    pub(super) pipelines: AtomicU32,
}

impl Made {
    /// Shader modules, checked and created.
    pub fn shaders(&self) -> u32 {
        self.shaders.load(Ordering::Relaxed)
    }

    /// Pipelines, created by the driver.
    pub fn pipelines(&self) -> u32 {
        self.pipelines.load(Ordering::Relaxed)
    }
}
