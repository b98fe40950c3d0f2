//! Frame series: a scene and the numbers of its frames that are measured.

use std::fmt;

use reflet_scene::{desc::CameraDesc, diagnostic::Diagnostic};

use super::Subject;

/// Function that poses a subject's world and camera at a frame, independent of the frame posed before.
pub type Mover = Box<dyn Fn(&mut Subject, u32) -> Result<(), Vec<Diagnostic>>>;

/// A scene and its measured frames, in order.
pub struct FrameSeries {
    subject: Subject,
    /// Number and camera of each frame.
    shots: Vec<(u32, CameraDesc)>,
    mover: Option<Mover>,
}

impl FrameSeries {
    /// Series of one frame of a still scene.
    pub fn still(subject: Subject) -> Self {
        Self {
            shots: vec![(subject.frame, subject.camera.clone())],
            subject,
            mover: None,
        }
    }

    /// Series of some frames of a scene. Every frame is posed once, so that errors show before anything is
    /// measured.
    ///
    /// # Errors
    /// Errors of the mover.
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

    /// Name of the scene in tables.
    pub fn name(&self) -> &str {
        &self.subject.name
    }

    /// Hash of the scene's content, as samples name it.
    pub fn content(&self) -> u64 {
        self.subject.content
    }

    /// Size of its pictures where the protocol has no sizes.
    pub fn size(&self) -> [u32; 2] {
        self.subject.image.size
    }

    /// Whether it asks for ray queries.
    pub fn may_query(&self) -> bool {
        self.subject.reflection.may_query()
    }

    /// Numbers of the frames that are measured.
    pub fn frames(&self) -> impl Iterator<Item = u32> {
        self.shots.iter().map(|(frame, _)| *frame)
    }

    /// Number of measured frames.
    pub(super) fn len(&self) -> usize {
        self.shots.len()
    }

    /// Subject with the number and camera of a measured frame, as fingerprints need it: its world is not posed.
    pub(super) fn seen(&mut self, index: usize) -> &Subject {
        let (frame, camera) = &self.shots[index];
        self.subject.frame = *frame;
        self.subject.camera.clone_from(camera);
        &self.subject
    }

    /// Subject posed at one of the measured frames.
    ///
    /// # Errors
    /// Same errors as [`FrameSeries::moving`].
    pub(super) fn posed(&mut self, index: usize) -> Result<&Subject, Vec<Diagnostic>> {
        self.posed_at(self.shots[index].0)
    }

    /// Subject posed at any frame; a still scene is not changed.
    ///
    /// # Errors
    /// Errors of the mover.
    pub fn posed_at(&mut self, frame: u32) -> Result<&Subject, Vec<Diagnostic>> {
        if let Some(mover) = &self.mover {
            mover(&mut self.subject, frame)?;
            self.subject.frame = frame;
        }
        Ok(&self.subject)
    }
}

impl fmt::Debug for FrameSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FrameSeries")
            .field("subject", &self.subject)
            .field("shots", &self.shots)
            .finish_non_exhaustive()
    }
}
