//! Files of pictures: PNG and EXR with AOVs, APNG and other films, written whole or not at all, and packs of scenes; and the rules for them,
//! which the command line and the module of Python share.
//!
//! This crate owns the formats ([`mod@format`]), names and lists of frames ([`frame_name`], [`frames`]), fingerprints by
//! which a run knows its files ([`fingerprint`]), the denoiser, a C library that is loaded at run time ([`denoise`]),
//! and the statistics of a picture ([`stats`]).

#[cfg(not(target_arch = "wasm32"))]
pub mod denoise;
pub mod error;
pub mod exr;
pub mod fingerprint;
pub mod format;
pub mod frame_name;
pub mod frames;
pub mod pack;
pub mod picture_file;
pub mod stats;
pub mod video;
pub mod writable;

#[cfg(test)]
mod tests;

pub use error::OutputError;
