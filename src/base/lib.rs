//! Tools that all crates of Reflet share: atomic file writes ([`files`]), the user's cache folder ([`cache`]), the clock
//! ([`clock`]), grouped digits ([`digits`]), boundaries around libraries
//! ([`guard`]), bounds and color over glam ([`math`]), the memory budget ([`memory`]), pseudo-random numbers
//! ([`pcg`]), clocks of processor time ([`processor_time`]), words for a shell ([`shell`]), standard error
//! ([`standard_error`]) and unique names ([`unique_names`]). This crate knows no scene and no device.

pub mod cache;
pub mod clock;
pub mod digits;
pub mod files;
pub mod guard;
pub mod math;
pub mod memory;
pub mod pcg;
pub mod processor_time;
pub mod shell;
pub mod standard_error;
pub mod unique_names;
