//! What the geometry of a file may take of the memory.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Fault;
use crate::memory::Budget;

/// What is left.
#[derive(Debug)]
pub struct GeometryBudget {
    /// To this file alone.
    file: Budget,
    /// To all that is loaded with it.
    load: Budget,
    /// Whether more was wanted than was left: the file is refused, and reading on is of no use.
    exceeded: AtomicBool,
}

fn over_budget() -> Fault {
    let text = "the file's geometry exceeds the memory budget";
    let help = "it is 2 GiB, or what the rest of the scene leaves of three quarters of the memory that is free, \
                if that is less";
    Fault::new("geometry-too-large", text).help(help)
}

impl GeometryBudget {
    /// What is left of both.
    pub fn new(file: Budget, load: Budget) -> Self {
        Self {
            file,
            load,
            exceeded: AtomicBool::new(false),
        }
    }

    /// Refuses all once something was refused.
    ///
    /// # Errors
    /// Something was refused.
    pub fn still_counts(&self) -> Result<(), Fault> {
        self.judge(!self.exceeded.load(Ordering::Relaxed))
    }

    fn judge(&self, fits: bool) -> Result<(), Fault> {
        if fits {
            return Ok(());
        }
        self.exceeded.store(true, Ordering::Relaxed);
        Err(over_budget())
    }

    /// Bytes that may still be taken.
    pub fn left(&self) -> u64 {
        self.file.left().min(self.load.left())
    }

    /// Refuses what is not left, before any of it is read.
    ///
    /// # Errors
    /// Fewer are left.
    pub fn check(&self, bytes: u64) -> Result<(), Fault> {
        self.judge(bytes <= self.left())
    }

    /// Takes bytes.
    ///
    /// # Errors
    /// Fewer are left.
    pub fn take(&self, bytes: u64) -> Result<(), Fault> {
        self.judge(self.file.take(bytes) && self.load.take(bytes))
    }
}
