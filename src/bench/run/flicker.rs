//! Pictures of the measured frame before, by which the temporal error of an animation is judged.

use std::{cell::RefCell, collections::HashMap};

use crate::bench::{
    metric::temporal::{Change, Temporal},
    picture::{Pair, PictureError},
    score::{Reference, View},
};

use super::{Subject, Variant};

/// The picture and the reference's of the last measured frame, of each size and setting: of the
/// frame, and of its mask.
#[derive(Debug, Default)]
pub struct Flicker(RefCell<HashMap<Key, (u32, [Temporal; 2])>>);

/// Size and setting.
type Key = ([u32; 2], String);

/// A change, and the frame since which.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Since {
    /// The measured frame before.
    pub frame: u32,
    /// The change since then.
    pub change: Change,
    /// The change inside the masks of both frames; none where these share too few pixels.
    pub mask: Option<Change>,
}

impl Flicker {
    /// Adds a frame; none for the first of an animation, and for a still scene.
    ///
    /// # Errors
    /// When the sizes differ.
    pub(super) fn push(
        &self,
        subject: &Subject,
        variant: &Variant,
        view: &View,
        reference: &Reference,
    ) -> Result<Option<Since>, PictureError> {
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
        Ok(change.map(|change| Since {
            frame: before,
            change,
            mask,
        }))
    }

    /// Forgets settings at a size: their frame is passed over, and what follows it has no frame
    /// before.
    pub(super) fn forget(&self, size: [u32; 2], variants: &[Variant]) {
        let mut known = self.0.borrow_mut();
        for variant in variants {
            known.remove(&(size, format!("{variant:?}")));
        }
    }

    /// Forgets all.
    pub(super) fn clear(&self) {
        self.0.borrow_mut().clear();
    }
}
