//! A scene and those of its frames that are measured.

use std::fmt;

use crate::scene::{desc::CameraDesc, diagnostic::Diagnostic};

use super::Subject;

/// Poses a subject's world and camera at a frame, whatever frame it showed before.
pub type Mover = Box<dyn Fn(&mut Subject, u32) -> Result<(), Vec<Diagnostic>>>;

/// A scene and those of its frames that are measured, one after another.
pub struct FrameSeries {
    subject: Subject,
    /// Number and camera of each frame.
    shots: Vec<(u32, CameraDesc)>,
    mover: Option<Mover>,
}

impl FrameSeries {
    /// One frame of a scene that stands still.
    pub fn still(subject: Subject) -> Self {
        Self {
            shots: vec![(subject.frame, subject.camera.clone())],
            subject,
            mover: None,
        }
    }

    /// Some frames of a scene. Each is posed, so that what cannot be shows before anything is
    /// measured.
    ///
    /// # Errors
    /// What the mover refuses.
    pub fn moving(
        mut subject: Subject,
        frames: &[u32],
        mover: Mover,
    ) -> Result<Self, Vec<Diagnostic>> {
        subject.motion = frames.len() > 1;
        let mut shots = Vec::with_capacity(frames.len());
        for frame in frames {
            mover(&mut subject, *frame)?;
            shots.push((*frame, subject.camera.clone()));
        }
        Ok(Self {
            subject,
            shots,
            mover: Some(mover),
        })
    }

    /// What tables call the scene.
    pub fn name(&self) -> &str {
        &self.subject.name
    }

    /// Hash of the scene's content, as samples name it.
    pub fn content(&self) -> u64 {
        self.subject.content
    }

    /// Size of its pictures where the protocol has none.
    pub fn size(&self) -> [u32; 2] {
        self.subject.image.size
    }

    /// Numbers of the frames that are measured.
    pub fn frames(&self) -> impl Iterator<Item = u32> {
        self.shots.iter().map(|(frame, _)| *frame)
    }

    /// How many frames are measured.
    pub(super) fn len(&self) -> usize {
        self.shots.len()
    }

    /// The subject at one of the measured frames as far as fingerprints ask: its world is not posed.
    pub(super) fn seen(&mut self, index: usize) -> &Subject {
        let (frame, camera) = &self.shots[index];
        self.subject.frame = *frame;
        self.subject.camera.clone_from(camera);
        &self.subject
    }

    /// The subject posed at one of the measured frames.
    ///
    /// # Errors
    /// As [`FrameSeries::moving`].
    pub(super) fn posed(&mut self, index: usize) -> Result<&Subject, Vec<Diagnostic>> {
        self.at(self.shots[index].0)
    }

    /// The subject posed at any frame; one that stands still, as it is.
    ///
    /// # Errors
    /// What the mover refuses.
    pub fn at(&mut self, frame: u32) -> Result<&Subject, Vec<Diagnostic>> {
        if let Some(mover) = &self.mover {
            mover(&mut self.subject, frame)?;
            self.subject.frame = frame;
        }
        Ok(&self.subject)
    }
}

impl fmt::Debug for FrameSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reel")
            .field("subject", &self.subject)
            .field("shots", &self.shots)
            .finish_non_exhaustive()
    }
}
