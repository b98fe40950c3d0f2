//! Parameter trials: overrides of script parameters are tried on the scene on disk, then accepted
//! with it, or refused in favor of the previous values.

use super::{Live, Problems, Reload};
use crate::{
    app::params::{DeclaredParameters, ParameterOverrides},
    scene::desc::ParamValue,
};

/// Refused parameter values.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Names and refused values.
    pub values: Vec<(String, ParamValue)>,
    /// Overrides in effect.
    pub stays: ParameterOverrides,
    /// Errors that they caused.
    pub why: Problems,
}

/// State of requested values.
#[derive(Clone, Debug)]
enum Trial {
    /// Overrides for the next read.
    Requested(ParameterOverrides),
    /// A read with them failed; a read without them tells whether they are the cause.
    Suspected(ParameterOverrides, Box<Problems>),
}

/// The current trial and the result to report.
#[derive(Clone, Debug, Default)]
pub(super) struct TrialState {
    current: Option<Trial>,
    refusal: Option<Refusal>,
    /// Whether the scene must be read again, without the tried values.
    must_read_again: bool,
}

impl Live {
    /// Script parameters declared by the scene, with `--set` applied.
    pub fn declared(&self) -> &DeclaredParameters {
        &self.declared
    }

    /// Overrides of the declared parameters.
    pub fn parameters(&self) -> &ParameterOverrides {
        &self.parameters
    }

    /// Requests other parameter overrides for the next [`Live::read_job`]. Values that fail are
    /// refused, see [`Live::refusal`].
    pub fn set_parameters(&mut self, parameters: ParameterOverrides) {
        self.trial.current = Some(Trial::Requested(parameters));
    }

    /// Overrides for the next read.
    pub(super) fn requested_parameters(&self) -> &ParameterOverrides {
        match &self.trial.current {
            Some(Trial::Requested(parameters)) => parameters,
            _ => &self.parameters,
        }
    }

    /// Whether the last read failed with tried values, so that the scene must be read again.
    pub fn must_read_again(&mut self) -> bool {
        std::mem::take(&mut self.trial.must_read_again)
    }

    /// Values refused since the last call.
    pub fn refusal(&mut self) -> Option<Refusal> {
        self.trial.refusal.take()
    }

    /// Accepts or suspects the values of a finished read; `is_trial` if they differ from the shown
    /// ones, `before` are the problems before the read.
    pub(super) fn finish_trial(
        &mut self,
        asked: &ParameterOverrides,
        is_trial: bool,
        before: Problems,
        reload: &Reload,
    ) {
        let now = self.trial.current.take();
        let is_current = matches!(&now, Some(Trial::Requested(wanted)) if wanted == asked);
        // An unreadable text says nothing about the values.
        let is_readable = reload.ok || !self.problems.pose.is_empty();
        self.trial.current = match now {
            now if is_trial && !reload.ok => {
                let why = std::mem::replace(&mut self.problems, before);
                self.pending = None;
                self.trial.must_read_again = true;
                if is_current {
                    Some(Trial::Suspected(asked.clone(), why.into()))
                } else {
                    now // values requested since
                }
            }
            Some(Trial::Suspected(parameters, why)) if is_readable => {
                self.refuse(&parameters, *why);
                None
            }
            Some(Trial::Suspected(parameters, _)) => Some(Trial::Requested(parameters)),
            now => now.filter(|_| !is_current),
        };
    }

    fn refuse(&mut self, parameters: &ParameterOverrides, why: Problems) {
        let values: Vec<_> = (self.declared.iter())
            .map(|(name, own)| (name, parameters.get(name).unwrap_or(own), own))
            .filter(|(name, value, own)| *value != self.parameters.get(name).unwrap_or(own))
            .map(|(name, value, _)| (name.clone(), value.clone()))
            .collect();
        self.trial.refusal = (!values.is_empty()).then(|| Refusal {
            values,
            stays: self.parameters.clone(),
            why,
        });
    }
}
