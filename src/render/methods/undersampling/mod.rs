//! Rays of some pixels only, whose hits the pixels around them share where they agree.

pub mod lead;
pub mod spread;

use super::{MethodRow, Place};
use crate::pipeline::frame_pass::FrameRow;
use lead::Lead;
use spread::Spread;

/// Entry of undersampling.
pub(super) const ROW: MethodRow = MethodRow {
    adopt: |own, asked| own.similarity = asked.similarity,
    passes: &[
        (Place::Lead, FrameRow::new::<Lead>(&lead::PASS)),
        (Place::Lead, FrameRow::new::<Spread>(&spread::PASS)),
    ],
    ..MethodRow::NONE
};
