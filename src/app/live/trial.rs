//! Values that are laid over a script's parameters: tried on the scene as it is on disk, then taken
//! over with it, or refused so that everything goes on with the values before.

use super::{Live, Problems, Reload};
use crate::{app::params::Tuned, scene::desc::ParamValue};

/// Values that do not work.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Names and values.
    pub values: Vec<(String, ParamValue)>,
    /// What is laid over the parameters all the same.
    pub stays: Tuned,
    /// What is wrong with them.
    pub why: Problems,
}

/// How far values that were asked for have come.
#[derive(Clone, Debug)]
enum Trial {
    /// Laid over the next reading.
    Wanted(Tuned),
    /// It failed; whether that is their fault is seen by reading without them.
    Doubted(Tuned, Box<Problems>),
}

/// What was asked for, and what is to be told of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Trials {
    now: Option<Trial>,
    refusal: Option<Refusal>,
    /// Whether the last reading says nothing about the scene itself.
    reads_again: bool,
}

impl Live {
    /// Lays other values over the script's parameters, for the next [`Live::reading`]. Those that
    /// work stay; for those that do not, see [`Live::refusal`].
    pub fn tune(&mut self, tuned: Tuned) {
        self.trials.now = Some(Trial::Wanted(tuned));
    }

    /// What the next reading lays over the parameters.
    pub(super) fn asked(&self) -> &Tuned {
        match &self.trials.now {
            Some(Trial::Wanted(tuned)) => tuned,
            _ => &self.tuned,
        }
    }

    /// Whether the last reading failed with values that were only tried: nothing came of it, and the
    /// scene must be read anew.
    pub fn reads_again(&mut self) -> bool {
        std::mem::take(&mut self.trials.reads_again)
    }

    /// Values that were refused since the last time.
    pub fn refusal(&mut self) -> Option<Refusal> {
        self.trials.refusal.take()
    }

    /// Judges what a reading with these values, `is_trial` if others are shown, came to; `before` it
    /// there were these problems.
    pub(super) fn judge(
        &mut self,
        asked: &Tuned,
        is_trial: bool,
        before: Problems,
        reload: &Reload,
    ) {
        let now = self.trials.now.take();
        let is_wanted = matches!(&now, Some(Trial::Wanted(wanted)) if wanted == asked);
        // Where the text itself cannot be read, nothing is known of the values.
        let is_readable = reload.ok || !self.problems.pose.is_empty();
        self.trials.now = match now {
            now if is_trial && !reload.ok => {
                let why = std::mem::replace(&mut self.problems, before);
                self.waiting = None;
                self.trials.reads_again = true;
                if is_wanted {
                    Some(Trial::Doubted(asked.clone(), why.into()))
                } else {
                    now // newer ones
                }
            }
            Some(Trial::Doubted(tuned, why)) if is_readable => {
                self.refuse(&tuned, *why);
                None
            }
            Some(Trial::Doubted(tuned, _)) => Some(Trial::Wanted(tuned)),
            now => now.filter(|_| !is_wanted),
        };
    }

    fn refuse(&mut self, tuned: &Tuned, why: Problems) {
        let values: Vec<_> = (self.declared.iter())
            .map(|(name, own)| (name, tuned.get(name).unwrap_or(own), own))
            .filter(|(name, value, own)| *value != self.tuned.get(name).unwrap_or(own))
            .map(|(name, value, _)| (name.clone(), value.clone()))
            .collect();
        self.trials.refusal = (!values.is_empty()).then(|| Refusal {
            values,
            stays: self.tuned.clone(),
            why,
        });
    }
}
