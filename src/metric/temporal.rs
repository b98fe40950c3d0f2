//! Flicker: how much the frame-to-frame changes of a sequence differ from its reference's.

use super::mask::{MIN_AREA_PX, Mask};
use crate::picture::{Pair, PictureError};

/// Flicker meter of a sequence; keeps only the previous frame in memory.
#[derive(Clone, Debug, Default)]
pub struct Temporal {
    previous: Option<Frame>,
}

/// Change of one frame since the frame before, in display code values (0 to 255).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Mean |Δtest − Δref|.
    pub difference: f64,
    /// Mean |Δref|.
    pub reference: f64,
}

#[derive(Clone, Debug)]
struct Frame {
    size: [usize; 2],
    test: Vec<[f32; 3]>,
    reference: Vec<[f32; 3]>,
    /// Whether each pixel is inside the mask; none without a mask.
    inside: Option<Vec<bool>>,
}

impl Temporal {
    /// Meter without frames.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the next frame of both sequences; returns its change since the frame before, none for
    /// the first. With masks, of the same size, the change of the pixels inside the masks of both frames;
    /// none where these are fewer than [`MIN_AREA_PX`].
    ///
    /// # Errors
    /// When its size differs from the frames before; the frame is then not added.
    pub fn push(
        &mut self,
        pair: &Pair,
        mask: Option<&Mask>,
    ) -> Result<Option<Change>, PictureError> {
        let frame = Frame {
            size: [pair.test().width(), pair.test().height()],
            test: pair.test().display(),
            reference: pair.reference().display(),
            inside: mask.map(|mask| mask.inside().to_vec()),
        };
        let mut since = None;
        if let Some(previous) = &self.previous {
            if previous.size != frame.size {
                return Err(PictureError::Size {
                    first: frame.size,
                    second: previous.size,
                });
            }
            since = change(previous, &frame);
        }
        self.previous = Some(frame);
        Ok(since)
    }
}

/// Flicker ratio: mean |Δtest − Δref| over mean |Δref| of `pairs` pairs of frames, from the sums of their
/// changes; none without a pair. 0 when the test changes exactly as the reference does, so also when
/// neither changes; infinite when only the test changes.
pub fn ratio(pairs: usize, difference: f64, reference: f64) -> Option<f64> {
    match (pairs, difference) {
        (0, _) => None,
        (_, 0.0) => Some(0.0),
        _ => Some(difference / reference),
    }
}

/// Means of |Δtest − Δref| and |Δref| over all channels of the pixels inside the masks of both frames.
fn change(before: &Frame, after: &Frame) -> Option<Change> {
    let counts = |frame: &Frame, pixel: usize| frame.inside.as_ref().is_none_or(|i| i[pixel]);
    let (mut pixels, mut difference, mut reference) = (0_usize, 0.0, 0.0);
    for pixel in 0..before.test.len() {
        if !counts(before, pixel) || !counts(after, pixel) {
            continue;
        }
        pixels += 1;
        for channel in 0..3 {
            let since = |after: &[[f32; 3]], before: &[[f32; 3]]| {
                f64::from(after[pixel][channel] - before[pixel][channel])
            };
            let moved = since(&after.reference, &before.reference);
            difference += (since(&after.test, &before.test) - moved).abs();
            reference += moved.abs();
        }
    }
    if after.inside.is_some() && pixels < MIN_AREA_PX {
        return None;
    }
    let channels = (3 * pixels).max(1) as f64;
    Some(Change {
        difference: difference / channels,
        reference: reference / channels,
    })
}
