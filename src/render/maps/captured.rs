//! Record of the content of captured maps, so that they are captured anew only when it changes.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Upkeep of maps, whatever their content follows from.
pub trait Upkeep {
    /// Makes the next picture capture the maps.
    fn forget(&self);

    /// Keeps the time of a capture, milliseconds.
    fn set_ms(&self, ms: f64);

    /// Time of the last capture, milliseconds: processor time where it is known.
    fn ms(&self) -> f64;
}

/// Values that the content of maps follows from, and the time of its capture.
#[derive(Debug)]
pub struct Captured<K>(Mutex<State<K>>);

#[derive(Debug)]
struct State<K> {
    /// Values of the last capture; `None` where maps must be captured.
    shown: Option<K>,
    /// Time of the last capture, milliseconds.
    ms: f64,
}

impl<K> Default for Captured<K> {
    /// Maps that show nothing yet.
    fn default() -> Self {
        let (shown, ms) = (None, 0.0);
        Self(Mutex::new(State { shown, ms }))
    }
}

impl<K: PartialEq> Captured<K> {
    fn state(&self) -> MutexGuard<'_, State<K>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the values of the next picture, and says whether the maps must be captured for it.
    pub fn replace(&self, needed: K) -> bool {
        let mut state = self.state();
        let differs = state.shown.as_ref() != Some(&needed);
        state.shown = Some(needed);
        differs
    }
}

impl<K: PartialEq> Upkeep for Captured<K> {
    fn forget(&self) {
        self.state().shown = None;
    }

    fn set_ms(&self, ms: f64) {
        self.state().ms = ms;
    }

    fn ms(&self) -> f64 {
        self.state().ms
    }
}

#[cfg(test)]
mod tests {
    use super::{Captured, Upkeep as _};

    #[test]
    fn only_what_differs_or_is_forgotten_is_captured() {
        let captured = Captured::default();
        let needed = [1, 1, 2, 2, 1].map(|value| captured.replace(value));
        assert_eq!(needed, [true, false, true, false, true]);
        captured.forget();
        assert!(captured.replace(1));
    }
}
