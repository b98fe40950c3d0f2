//! Files of pictures and films: there whole or not at all.

pub mod exr;
pub mod format;
pub mod picture_file;
pub mod png;
pub mod video;
pub mod writable;

#[cfg(test)]
mod tests;
