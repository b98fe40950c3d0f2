//! Flicker: how much a sequence changes from frame to frame otherwise than its reference.

use crate::bench::picture::{Pair, PictureError};

/// The changes of a sequence, two frames in memory at a time.
#[derive(Clone, Debug, Default)]
pub struct Temporal {
    previous: Option<Frame>,
}

/// How one frame changed since the one before it, in display code values (0 to 255).
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
}

impl Temporal {
    /// No frames yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the next frame of both sequences; gives its change since the frame before, none for
    /// the first.
    ///
    /// # Errors
    /// When its size differs from the frames before; the frame is then not added.
    pub fn push(&mut self, pair: &Pair) -> Result<Option<Change>, PictureError> {
        let frame = Frame {
            size: [pair.test().width(), pair.test().height()],
            test: pair.test().display(),
            reference: pair.reference().display(),
        };
        let mut since = None;
        if let Some(previous) = &self.previous {
            if previous.size != frame.size {
                return Err(PictureError::Size {
                    first: frame.size,
                    second: previous.size,
                });
            }
            since = Some(change(previous, &frame));
        }
        self.previous = Some(frame);
        Ok(since)
    }
}

/// Mean |Δtest − Δref| over mean |Δref| of `pairs` pairs of frames, from the sums of their changes;
/// none without a pair. 0 when the test changes exactly as the reference does, so also when both
/// stand still; infinite when only the test changes.
pub fn ratio(pairs: usize, difference: f64, reference: f64) -> Option<f64> {
    match (pairs, difference) {
        (0, _) => None,
        (_, 0.0) => Some(0.0),
        _ => Some(difference / reference),
    }
}

/// Means over all channels of |Δtest − Δref| and |Δref|.
fn change(before: &Frame, after: &Frame) -> Change {
    let test = before
        .test
        .as_flattened()
        .iter()
        .zip(after.test.as_flattened());
    let reference = before
        .reference
        .as_flattened()
        .iter()
        .zip(after.reference.as_flattened());
    let channels = (3 * before.test.len()).max(1) as f64;
    let (difference, reference) =
        test.zip(reference)
            .fold((0.0, 0.0), |(difference, total), ((t0, t1), (r0, r1))| {
                let moved = f64::from(r1 - r0);
                (
                    difference + (f64::from(t1 - t0) - moved).abs(),
                    total + moved.abs(),
                )
            });
    Change {
        difference: difference / channels,
        reference: reference / channels,
    }
}
