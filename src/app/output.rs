//! Picture and film files, written atomically.

pub mod exr;
pub mod format;
pub mod picture_file;
pub mod video;
pub mod writable;

#[cfg(test)]
mod tests;
