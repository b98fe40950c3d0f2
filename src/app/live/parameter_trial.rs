//! Values that are laid over a script's parameters: tried on the scene as it is on disk, then taken
//! over with it, or refused so that everything goes on with the values before.

use super::{Live, Problems, Reload};
use crate::{app::params::ParameterOverrides, scene::desc::ParamValue};

/// Values that do not work.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Names and values.
    pub values: Vec<(String, ParamValue)>,
    /// What is laid over the parameters all the same.
    pub stays: ParameterOverrides,
    /// What is wrong with them.
    pub why: Problems,
}

/// How far values that were asked for have come.
#[derive(Clone, Debug)]
enum Trial {
    /// Laid over the next reading.
    Wanted(ParameterOverrides),
    /// It failed; whether that is their fault is seen by reading without them.
    Doubted(ParameterOverrides, Box<Problems>),
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
    pub fn tune(&mut self, parameters: ParameterOverrides) {
        self.trials.now = Some(Trial::Wanted(parameters));
    }

    /// What the next reading lays over the parameters.
    pub(super) fn asked(&self) -> &ParameterOverrides {
        match &self.trials.now {
            Some(Trial::Wanted(parameters)) => parameters,
            _ => &self.parameters,
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
        asked: &ParameterOverrides,
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
            Some(Trial::Doubted(parameters, why)) if is_readable => {
                self.refuse(&parameters, *why);
                None
            }
            Some(Trial::Doubted(parameters, _)) => Some(Trial::Wanted(parameters)),
            now => now.filter(|_| !is_wanted),
        };
    }

    fn refuse(&mut self, parameters: &ParameterOverrides, why: Problems) {
        let values: Vec<_> = (self.declared.iter())
            .map(|(name, own)| (name, parameters.get(name).unwrap_or(own), own))
            .filter(|(name, value, own)| *value != self.parameters.get(name).unwrap_or(own))
            .map(|(name, value, _)| (name.clone(), value.clone()))
            .collect();
        self.trials.refusal = (!values.is_empty()).then(|| Refusal {
            values,
            stays: self.parameters.clone(),
            why,
        });
    }
}
