//! A second depth layer for the march: the surfaces behind the first.

pub mod peel;
pub mod stats;

use super::{MethodRow, Place};
use crate::pipeline::frame_pass::FrameRow;
use peel::Peel;

/// Entry of the second layer.
pub(super) const ROW: MethodRow = MethodRow {
    adopt: |own, asked| own.separation_m = asked.separation_m,
    passes: &[(Place::March, FrameRow::new::<Peel>(&peel::PASS))],
    ..MethodRow::NONE
};
