//! What the geometry of a file may take of the memory.

use super::Fault;
use crate::memory::Budget;

/// What is left.
#[derive(Debug)]
pub struct GeometryBudget {
    /// To this file alone.
    pub file: Budget,
    /// To all that is loaded with it.
    pub load: Budget,
}

fn over_budget() -> Fault {
    let text = "the file's geometry exceeds the memory budget";
    let help = "it is 2 GiB, or what the rest of the scene leaves of three quarters of the memory that is free, \
                if that is less";
    Fault::new("geometry-too-large", text).help(help)
}

impl GeometryBudget {
    /// Bytes that may still be taken.
    pub fn left(&self) -> u64 {
        self.file.left().min(self.load.left())
    }

    /// Refuses what is not left, before any of it is read.
    ///
    /// # Errors
    /// Fewer are left.
    pub fn check(&self, bytes: u64) -> Result<(), Fault> {
        match bytes <= self.left() {
            true => Ok(()),
            false => Err(over_budget()),
        }
    }

    /// Takes bytes.
    ///
    /// # Errors
    /// Fewer are left.
    pub fn take(&self, bytes: u64) -> Result<(), Fault> {
        match self.file.take(bytes) && self.load.take(bytes) {
            true => Ok(()),
            false => Err(over_budget()),
        }
    }
}
