//! `compare` through the library: reading, metrics, writing.

mod bad_input;
mod files;
mod outputs;
mod reading;

// Names that most tests of `compare` need.
pub use crate::common::{assert_says, folder::Folder};
pub use files::{fails, run};
pub use image::{Rgb, RgbImage};
pub use reflet::metric::{
    picture::{Encoding, Picture},
    read::read_picture,
};
pub use std::{
    fs,
    path::{Path, PathBuf},
};
