//! Settings of a frame: its options, its view, the precision of stored light, and the origin and unit that coordinates
//! are relative to.

pub(crate) mod coordinates;
pub mod cutoff;
pub mod offsets;
pub mod options;
pub mod pixel_share;
pub mod precision;
pub mod view;
