//! Counters of compiled shaders and pipelines, for reload statistics.

use std::{
    sync::atomic::{AtomicU32, AtomicU64, Ordering},
    time::Duration,
};

use reflet_base::clock::Instant;

/// Running counts; statistics of a reload are differences of two readings.
#[derive(Debug, Default)]
pub struct CompileStats {
    pub(super) shaders: AtomicU32,
    pipelines: AtomicU32,
    driver_ns: AtomicU64,
}

impl CompileStats {
    /// Number of shader modules created.
    pub fn shaders(&self) -> u32 {
        self.shaders.load(Ordering::Relaxed)
    }

    /// Number of pipelines created.
    pub fn pipelines(&self) -> u32 {
        self.pipelines.load(Ordering::Relaxed)
    }

    /// Time spent in the driver to create pipelines.
    pub fn driver_time(&self) -> Duration {
        Duration::from_nanos(self.driver_ns.load(Ordering::Relaxed))
    }

    /// Calls `make` to create a pipeline, and counts and times the call.
    pub(super) fn pipeline<P>(&self, make: impl FnOnce() -> P) -> P {
        let started = Instant::now();
        let created = make();
        let ns = u64::try_from(started.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.driver_ns.fetch_add(ns, Ordering::Relaxed);
        self.pipelines.fetch_add(1, Ordering::Relaxed);
        created
    }
}
