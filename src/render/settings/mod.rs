//! Settings of a frame: its options, its view, the precision of stored light, and the origin and unit that coordinates
//! are relative to.

pub mod cutoff;
pub mod options;
pub mod pixel_share;
pub mod precision;
pub(crate) mod relative;
pub mod unit_costs;
pub mod view;
