//! Tools that all crates of Reflet share: atomic file writes ([`files`]), bounds and color over glam ([`math`]), the
//! memory budget ([`memory`]) and clocks of processor time ([`processor_time`]). This crate knows no scene and no device.

pub mod files;
pub mod math;
pub mod memory;
pub mod processor_time;
