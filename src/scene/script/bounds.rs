//! Limits that a thread sets for the calls of scripts that it begins, and the handle that ends them.

use std::{
    cell::{Cell, RefCell},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use super::limits::{DEADLINE, OPERATIONS};

/// Handle that ends calls of scripts from another thread; clones share their state.
#[derive(Clone, Debug, Default)]
pub struct Halt(Arc<AtomicBool>);

impl Halt {
    /// Ends calls under this handle within a few operations, and later calls at their start.
    pub fn halt(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Does work on this thread; calls of scripts in it fail once the handle is halted.
    pub fn over<T>(&self, work: impl FnOnce() -> T) -> T {
        let before = HALT.replace(Some(self.clone()));
        let result = work();
        HALT.set(before);
        result
    }

    /// Whether the handle was halted.
    pub fn is_halted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

thread_local! {
    /// Handle that can end the calls that this thread begins.
    static HALT: RefCell<Option<Halt>> = const { RefCell::new(None) };
    /// Limits of each of these calls.
    static BOUNDS: Cell<Bounds> = const { Cell::new(Bounds::CALL) };
    /// Time that is left to all of these calls together.
    pub(super) static LEFT: Cell<Option<Duration>> = const { Cell::new(None) };
}

/// Does work on this thread; all calls of scripts in it take together at most the time of one call.
pub fn together<T>(work: impl FnOnce() -> T) -> T {
    let before = LEFT.get();
    LEFT.set(Some(before.unwrap_or(DEADLINE)));
    let result = work();
    LEFT.set(before.and(LEFT.get()));
    result
}

/// Limits of a call in time and operations.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub(super) time: Duration,
    pub(super) operations: u64,
    /// Whether the time is what calls before have left of [`together`]'s.
    pub(super) is_rest: bool,
}

impl Bounds {
    /// Limits of any call.
    pub const CALL: Self = Self {
        time: DEADLINE,
        operations: OPERATIONS,
        is_rest: false,
    };

    /// The stricter of these limits and a time.
    pub fn within(self, time: Duration) -> Self {
        self.min(Self { time, ..Self::CALL })
    }

    /// These limits with at most this number of operations.
    pub fn at_most(self, operations: u64) -> Self {
        self.min(Self {
            operations,
            ..Self::CALL
        })
    }

    /// Does work on this thread; calls of scripts in it have these limits, for a host that allows less than the
    /// manual says.
    pub fn over<T>(self, work: impl FnOnce() -> T) -> T {
        let before = BOUNDS.replace(self.min(BOUNDS.get()));
        let result = work();
        BOUNDS.set(before);
        result
    }

    fn min(self, other: Self) -> Self {
        Self {
            time: self.time.min(other.time),
            operations: self.operations.min(other.operations),
            is_rest: false,
        }
    }

    /// Whether no operation is allowed.
    pub fn is_nothing(self) -> bool {
        self.operations == 0
    }
}

/// Limits of a call that this thread begins now, and the handle that can end it.
pub(super) fn of_next_call(bounds: Bounds) -> (Bounds, Option<Halt>) {
    let mut bounds = bounds.min(BOUNDS.get());
    if let Some(left) = LEFT.get().filter(|left| *left < bounds.time) {
        bounds = Bounds {
            time: left,
            is_rest: true,
            ..bounds
        };
    }
    (bounds, halt())
}

/// Handle that can end the calls that this thread begins.
pub(super) fn halt() -> Option<Halt> {
    HALT.with_borrow(Clone::clone)
}

/// Takes the time of a finished call from the time that all calls have left.
pub(super) fn take(time: Duration) {
    LEFT.set(LEFT.get().map(|left| left.saturating_sub(time)));
}
