//! Changes that are asked for and not shown yet: reads that wait or run, a scene whose frame cannot be posed,
//! and values of parameters that are tried.
//!
//! Values are tried on the scene on disk. A read that fails with them is followed by one without them, which
//! tells whether they are the cause: then they are refused.

use std::{sync::Arc, time::Instant};

use super::{Live, Problems, Reload};
use reflet_render::runtime::{
    model_viewer_scene::is_bare, parameters::ParameterOverrides, read::Read,
};
use reflet_scene::{desc::ParamValue, stages::Scene};

/// State of the shown scene that its successor reuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reuse {
    /// The scene that its texts and scripts describe.
    pub scene: bool,
    /// Models, images and other files.
    pub files: bool,
    /// Edits of materials.
    pub edits: bool,
}

impl Reuse {
    /// Everything, where no file changed.
    pub const ALL: Self = Self {
        scene: true,
        files: true,
        edits: true,
    };

    /// State that can be reused after both changes.
    pub fn and(self, other: Self) -> Self {
        Self {
            scene: self.scene && other.scene,
            files: self.files && other.files,
            edits: self.edits && other.edits,
        }
    }
}

impl Default for Reuse {
    fn default() -> Self {
        Self::ALL
    }
}

/// A requested read of the scene.
#[derive(Clone, Copy, Debug)]
pub struct ReadRequest {
    /// State that the new scene takes over.
    pub reuse: Reuse,
    /// Time of the first file event; `None` for parameters.
    pub saved_at: Option<Instant>,
    /// Work done for the same changes before the read: shaders that were built.
    pub before: Reload,
}

impl ReadRequest {
    /// A read with other values alone.
    pub const VALUES: Self = Self {
        reuse: Reuse {
            scene: false,
            ..Reuse::ALL
        },
        saved_at: None,
        before: Reload::NONE,
    };

    /// One read for two requests.
    fn then(self, new: Self) -> Self {
        Self {
            reuse: self.reuse.and(new.reuse),
            saved_at: new.saved_at.or(self.saved_at),
            before: self.before.and(new.before),
        }
    }
}

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

/// Changes that are asked for and not shown yet.
#[derive(Debug, Default)]
pub(super) struct Pending {
    /// Request of the next read.
    wanted: Option<ReadRequest>,
    /// Request of the read that runs.
    reading: Option<ReadRequest>,
    /// A scene whose requested frame cannot be posed; it is shown with the first frame that can.
    pub unposed: Option<(Read, Reuse)>,
    /// State that the next scene may reuse: less than everything after changes whose scene failed to be shown.
    pub reusable: Reuse,
    trial: Option<Trial>,
    refusal: Option<Refusal>,
}

impl Pending {
    /// The scene on disk, if it waits for a frame that can be posed.
    pub fn scene(&self) -> Option<&Arc<Scene>> {
        self.unposed.as_ref().map(|(read, _)| read.scene())
    }

    /// The read that ends answers this request.
    pub fn end_read(&mut self) -> Option<ReadRequest> {
        self.reading.take()
    }

    fn want(&mut self, request: ReadRequest) {
        self.wanted = Some(self.wanted.map_or(request, |wanted| wanted.then(request)));
    }
}

impl Live {
    /// Requests a read of the scene on disk.
    pub fn request_read(&mut self, request: ReadRequest) {
        self.pending.want(request);
    }

    /// The request that the next [`Live::begin_read`] answers.
    pub fn requested_read(&self) -> Option<&ReadRequest> {
        self.pending.wanted.as_ref()
    }

    /// The request that the read answers that runs.
    pub fn running_read(&self) -> Option<&ReadRequest> {
        self.pending.reading.as_ref()
    }

    /// Gives up the read that runs: it is requested again.
    pub fn leave_read(&mut self) {
        if let Some(reading) = self.pending.reading.take() {
            let wanted = self.pending.wanted.take();
            self.pending.wanted = Some(wanted.map_or(reading, |wanted| reading.then(wanted)));
        }
    }

    /// Takes the request that a new read answers, and gives up a running read for it, whose request it includes.
    pub(super) fn take_request(&mut self) -> Option<ReadRequest> {
        self.pending.wanted?;
        self.leave_read();
        self.pending.reading = self.pending.wanted.take();
        self.pending.reading
    }

    /// Requests other parameter overrides, and a read with them. Values that fail are refused, see
    /// [`Live::refusal`].
    pub fn set_parameters(&mut self, parameters: ParameterOverrides) {
        self.pending.trial = Some(Trial::Requested(parameters));
        self.pending.want(ReadRequest::VALUES);
    }

    /// Overrides for the next read.
    pub(super) fn requested_parameters(&self) -> &ParameterOverrides {
        match &self.pending.trial {
            Some(Trial::Requested(parameters)) => parameters,
            _ => self.parameters(),
        }
    }

    /// Whether the read that runs has no text and no script to read: neither they nor parameters have changed since
    /// the shown scene was read. The scene of a bare model describes the model, and is made anew with it.
    pub(super) fn reads_only_files(&self) -> bool {
        let is_asked = (self.pending.reading).is_some_and(|request| request.reuse.scene);
        let is_shown = self.pending.reusable.scene && self.pending.unposed.is_none();
        let path = self.source().path.as_deref();
        let is_current = is_asked && is_shown && self.pending.trial.is_none();
        is_current && !self.is_stand_in && !path.is_some_and(is_bare)
    }

    /// Values refused since the last call.
    pub fn refusal(&mut self) -> Option<Refusal> {
        self.pending.refusal.take()
    }

    /// Accepts or suspects the values of a finished read, which answered `request`; `is_trial` if they differ
    /// from the shown ones, `before` are the problems before the read. Returns whether that was the answer: else
    /// it is read again.
    pub(super) fn finish_trial(
        &mut self,
        asked: &ParameterOverrides,
        is_trial: bool,
        request: ReadRequest,
        before: Problems,
        reload: &Reload,
    ) -> bool {
        let now = self.pending.trial.take();
        let is_current = matches!(&now, Some(Trial::Requested(wanted)) if wanted == asked);
        // An unreadable text says nothing about the values.
        let is_readable = reload.ok || !self.problems.pose.is_empty();
        if is_trial && !reload.ok {
            let why = std::mem::replace(&mut self.problems, before);
            self.pending.unposed = None;
            self.pending.want(request);
            self.pending.trial = match is_current {
                true => Some(Trial::Suspected(asked.clone(), why.into())),
                false => now, // newer ones
            };
            return false;
        }
        self.pending.trial = match now {
            Some(Trial::Suspected(parameters, why)) if is_readable => {
                self.refuse(&parameters, *why);
                None
            }
            Some(Trial::Suspected(parameters, _)) => Some(Trial::Requested(parameters)),
            now => now.filter(|_| !is_current),
        };
        true
    }

    fn refuse(&mut self, parameters: &ParameterOverrides, why: Problems) {
        let values: Vec<_> = (self.declared().iter())
            .map(|(name, own)| (name, parameters.get(name).unwrap_or(own), own))
            .filter(|(name, value, own)| *value != self.parameters().get(name).unwrap_or(own))
            .map(|(name, value, _)| (name.clone(), value.clone()))
            .collect();
        self.pending.refusal = (!values.is_empty()).then(|| Refusal {
            values,
            stays: self.parameters().clone(),
            why,
        });
    }
}
