//! Temporary picture files to compare.

use clap::Parser;
use exr::prelude::*;
use image::{DynamicImage, ImageFormat};
use reflet::{
    app::compare::{CompareArgs, compare},
    metric::comparison::Comparison,
    scene::diagnostic::Diagnostic,
};

use super::*;
use crate::common::folder::names;

impl Folder {
    pub fn png(&self, name: &str, picture: impl Into<DynamicImage>) -> PathBuf {
        let path = self.path(name);
        picture
            .into()
            .save_with_format(&path, ImageFormat::Png)
            .expect("a PNG");
        path
    }

    /// An OpenEXR file with the given channels, each with a value per pixel.
    pub fn exr(&self, name: &str, size: [usize; 2], channels: Vec<(&str, Vec<f32>)>) -> PathBuf {
        let path = self.path(name);
        let list = channels
            .into_iter()
            .map(|(name, values)| AnyChannel::new(name, FlatSamples::F32(values)))
            .collect();
        let channels = AnyChannels::sort(list);
        let image = Image::from_channels((size[0], size[1]), channels);
        image.write().to_file(&path).expect("an OpenEXR file");
        path
    }

    pub fn names(&self) -> Vec<String> {
        names(&self.0)
    }
}

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    args: CompareArgs,
}

/// Runs `compare A B` with more options, through the option parser.
pub fn run(a: &Path, b: &Path, more: &[&str]) -> std::result::Result<Comparison, Box<Diagnostic>> {
    let [a, b] = [a, b].map(|p| p.to_str().expect("Unicode"));
    let words = ["compare", a, b].into_iter().chain(more.iter().copied());
    compare(&Line::try_parse_from(words).expect("good options").args)
}

/// Whether the option parser accepts these options.
pub fn parses(more: &[&str]) -> bool {
    Line::try_parse_from(["compare", "a.png", "b.png"].iter().chain(more)).is_ok()
}

/// Runs `compare` that must fail; returns the error's name, file and message.
pub fn fails(a: &Path, b: &Path, more: &[&str]) -> (&'static str, PathBuf, String) {
    let error = run(a, b, more).expect_err("must fail");
    assert!(error.help.is_some(), "no help: {error:?}");
    (error.name, error.file.expect("a file"), error.message)
}
