//! Memory budget for the geometry of a file.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Fault;
use reflet_base::memory::{Budget, Reservation};

/// Memory that geometry may still take.
#[derive(Debug)]
pub struct GeometryBudget {
    /// Budget of this file alone.
    file: Budget,
    /// Budget of all that is loaded with the file.
    load: Budget,
    /// Whether more was requested than was left: the file is refused then, and reading on is of no use.
    exceeded: AtomicBool,
}

fn over_budget() -> Fault {
    let text = "the file's geometry exceeds the memory budget";
    let help = "simplify the file; the budget is 2 GiB, or what the rest of the scene leaves of three quarters \
                of the free memory, if that is less";
    Fault::new("geometry-too-large", text).help(help)
}

impl GeometryBudget {
    /// A budget that is limited by both `file` and `load`.
    pub fn new(file: Budget, load: Budget) -> Self {
        Self {
            file,
            load,
            exceeded: AtomicBool::new(false),
        }
    }

    /// Fails once the budget was exceeded, so that no more of the file is read.
    ///
    /// # Errors
    /// The budget was exceeded before.
    pub fn check_not_exceeded(&self) -> Result<(), Fault> {
        self.judge(!self.exceeded.load(Ordering::Relaxed))
    }

    fn judge(&self, fits: bool) -> Result<(), Fault> {
        if fits {
            return Ok(());
        }
        self.exceeded.store(true, Ordering::Relaxed);
        Err(over_budget())
    }

    /// Number of bytes that may still be taken.
    pub fn left(&self) -> u64 {
        self.file.left().min(self.load.left())
    }

    /// Checks that so many bytes are left, without taking them.
    ///
    /// # Errors
    /// Fewer bytes are left.
    pub fn check(&self, bytes: u64) -> Result<(), Fault> {
        self.judge(bytes <= self.left())
    }

    /// Takes bytes.
    ///
    /// # Errors
    /// Fewer bytes are left.
    pub fn take(&self, bytes: u64) -> Result<(), Fault> {
        self.judge(self.file.take(bytes) && self.load.take(bytes))
    }

    /// Takes the bytes of a file that was read, which its images may be parts of: they stay in memory.
    ///
    /// # Errors
    /// Fewer bytes are left.
    pub fn take_file(&self, bytes: usize) -> Result<(), Fault> {
        match self.load.take(bytes as u64) {
            true => Ok(()),
            false => {
                let left = self.load.left();
                let text = format!("a file of {bytes} bytes is read, {left} are left");
                Err(Fault::new("file-too-large", text).help("leave out models, or simplify them"))
            }
        }
    }

    /// Takes bytes of the load until the result is dropped.
    ///
    /// # Errors
    /// Fewer bytes are left.
    pub fn hold(&self, bytes: u64) -> Result<Reservation, Fault> {
        let held = self.load.hold(bytes);
        self.judge(held.is_some())?;
        held.ok_or_else(over_budget)
    }
}
