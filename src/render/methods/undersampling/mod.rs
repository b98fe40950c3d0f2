//! Rays of some pixels only, whose hits the pixels around them share where they agree.

pub mod split_rays;
pub mod upsample;

use super::{MethodRow, Place};
use crate::pipeline::{frame_pass::FrameRow, pass::Dispatch, ray_list::List};

/// Entry of undersampling.
pub(super) const ROW: MethodRow = MethodRow {
    adopt: |own, asked| own.similarity = asked.similarity,
    passes: &[
        (
            Place::Split,
            FrameRow::over(&split_rays::PASS, Dispatch::Listed(List::Rays)),
        ),
        (
            Place::Undersample,
            FrameRow::compute(&upsample::PASS, upsample::record),
        ),
    ],
    ..MethodRow::NONE
};
