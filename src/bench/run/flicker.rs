//! Pictures of the previous measured frame, for the temporal error of an animation.

use std::{cell::RefCell, collections::HashMap};

use crate::score::{Reference, View};
use reflet_metric::{
    picture::{Pair, PictureError},
    temporal::{Change, Temporal},
};

use super::{Subject, Variant};

/// Frame number and pictures (test and reference) of the last measured frame for each size and setting,
/// for the whole frame and inside the mask.
#[derive(Debug, Default)]
pub struct Flicker(RefCell<HashMap<Key, (u32, [Temporal; 2])>>);

/// Picture size and setting.
type Key = ([u32; 2], String);

/// Change since the previous measured frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameChange {
    /// Number of the previous measured frame.
    pub frame: u32,
    /// Change of the whole frame.
    pub change: Change,
    /// Change inside the masks of both frames; none where these share too few pixels.
    pub mask: Option<Change>,
}

impl Flicker {
    /// Adds a frame and returns its change; none for the first frame of an animation, and for a still scene.
    ///
    /// # Errors
    /// When the sizes differ.
    pub(super) fn push(
        &self,
        subject: &Subject,
        variant: &Variant,
        view: &View,
        reference: &Reference,
    ) -> Result<Option<FrameChange>, PictureError> {
        if !subject.motion {
            return Ok(None);
        }
        let pair = Pair::new(&view.display, &reference.view.display)?;
        let size = [pair.test().width(), pair.test().height()].map(|side| side as u32);
        let mut known = self.0.borrow_mut();
        let entry = known.entry((size, format!("{variant:?}")));
        let (frame, [whole, masked]) = entry.or_insert_with(|| (subject.frame, Default::default()));
        let before = std::mem::replace(frame, subject.frame);
        let change = whole.push(&pair, None)?;
        let mask = masked.push(&pair, Some(&reference.mask))?;
        Ok(change.map(|change| FrameChange {
            frame: before,
            change,
            mask,
        }))
    }

    /// Removes settings at a size, because their frame is skipped: the frame after it has no previous
    /// frame.
    pub(super) fn forget(&self, size: [u32; 2], variants: &[Variant]) {
        let mut known = self.0.borrow_mut();
        for variant in variants {
            known.remove(&(size, format!("{variant:?}")));
        }
    }

    /// Removes all pictures.
    pub(super) fn clear(&self) {
        self.0.borrow_mut().clear();
    }
}
