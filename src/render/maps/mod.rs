//! Maps that are drawn before a frame and kept: shadow maps, and maps that a method captures.

pub(crate) mod captured;
pub mod cube;
pub mod method_maps;
pub(crate) mod shadow_maps;
