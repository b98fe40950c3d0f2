//! Counts what is costly to make on the device, so that a reload can say what it made again.

use std::{
    sync::atomic::{AtomicU32, AtomicU64, Ordering},
    time::{Duration, Instant},
};

/// How many costly things were made so far; a reload is measured by what it adds.
#[derive(Debug, Default)]
pub struct CompileStats {
    pub(super) shaders: AtomicU32,
    pipelines: AtomicU32,
    driver_ns: AtomicU64,
}

impl CompileStats {
    /// Shader modules, checked and created.
    pub fn shaders(&self) -> u32 {
        self.shaders.load(Ordering::Relaxed)
    }

    /// Pipelines, created by the driver.
    pub fn pipelines(&self) -> u32 {
        self.pipelines.load(Ordering::Relaxed)
    }

    /// How long the driver took for them.
    pub fn driver_time(&self) -> Duration {
        Duration::from_nanos(self.driver_ns.load(Ordering::Relaxed))
    }

    /// Counts the pipeline that `make` gives, and the time it takes.
    pub(super) fn pipeline<P>(&self, make: impl FnOnce() -> P) -> P {
        let started = Instant::now();
        let created = make();
        let ns = u64::try_from(started.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.driver_ns.fetch_add(ns, Ordering::Relaxed);
        self.pipelines.fetch_add(1, Ordering::Relaxed);
        created
    }
}
