//! Rays of some pixels only, whose hits the pixels around them share where they agree.

pub mod lead;
pub mod spread;

use super::{MethodRow, Place};
use crate::pipeline::frame_pass::FrameRow;

/// Entry of undersampling.
pub(super) const ROW: MethodRow = MethodRow {
    adopt: |own, asked| own.similarity = asked.similarity,
    passes: &[
        (Place::Lead, FrameRow::compute(&lead::PASS, lead::record)),
        (
            Place::Lead,
            FrameRow::compute(&spread::PASS, spread::record),
        ),
    ],
    ..MethodRow::NONE
};
