//! Temporary picture files to compare.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::atomic::{AtomicUsize, Ordering},
};

use clap::Parser;
use exr::prelude::*;
use image::{DynamicImage, ImageFormat};
use reflet::{
    app::compare::{CompareArgs, compare},
    metric::comparison::Comparison,
    scene::diagnostic::Diagnostic,
};

/// A folder that is removed after the test.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new() -> Self {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let unique = format!(
            "{}-{}",
            std::process::id(),
            NEXT.fetch_add(1, Ordering::Relaxed)
        );
        let path = std::env::temp_dir().join(format!("reflet-compare-{unique}"));
        fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, bytes).expect("a temporary file");
        path
    }

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
        let entries = fs::read_dir(&self.0).expect("the folder");
        let name = |e: std::io::Result<fs::DirEntry>| e.expect("an entry").file_name();
        let mut names: Vec<String> = entries.map(|e| name(e).to_string_lossy().into()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
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
