//! Names that most tests of scene text need.

pub use crate::common::{
    Random, assert_says, cases,
    folder::{Folder, kept_folder},
};
pub use glam::Vec3;
pub use reflet::scene::{
    dependencies::Dependencies,
    diagnostic::{Diagnostic, render_all},
    stages::{Animator, Scene},
};
pub use std::{
    fs,
    path::{Path, PathBuf},
};
