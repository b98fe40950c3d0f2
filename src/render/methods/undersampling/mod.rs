//! Rays of some pixels only, whose hits the pixels around them share where they agree.

pub mod trace_sparse;
pub mod upsample;

use super::{MethodRow, Place};
use crate::pipeline::frame_pass::FrameRow;

/// Entry of undersampling.
pub(super) const ROW: MethodRow = MethodRow {
    adopt: |own, asked| own.similarity = asked.similarity,
    passes: &[
        (
            Place::Undersample,
            FrameRow::compute(&trace_sparse::PASS, trace_sparse::record),
        ),
        (
            Place::Undersample,
            FrameRow::compute(&upsample::PASS, upsample::record),
        ),
    ],
    ..MethodRow::NONE
};
