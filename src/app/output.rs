//! Picture files: PNG and EXR, written so that a file is there whole or not at all.

use std::{
    fs::{self, File, OpenOptions},
    io::{Cursor, Write as _},
    path::{Path, PathBuf},
};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec, Vec2,
    WritableImage as _,
};
use image::{ExtendedColorType, ImageEncoder as _, codecs::png::PngEncoder};

use super::{aov, error::AppError};
use crate::render::{Picture, Plane, PlaneData};

/// What an output file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// 8 bits, tone-mapped.
    Png,
    /// Linear 32-bit floats, with intermediate pictures as layers.
    Exr,
}

/// An output path that looked writable when the command began.
#[derive(Clone, Debug)]
pub struct Output {
    path: PathBuf,
    format: Format,
}

impl Output {
    /// Checks extension and folder before any time is spent on rendering.
    ///
    /// # Errors
    /// [`AppError::Usage`] saying which part of the path is wrong.
    pub fn new(path: &Path) -> Result<Self, AppError> {
        let shown = path.display();
        let usage = |text: String| Err(AppError::Usage(text));
        let extension = path.extension().and_then(|extension| extension.to_str());
        let format = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("png") => Format::Png,
            Some("exr") => Format::Exr,
            _ => {
                return usage(format!(
                    "--output {shown}: the name must end in .png or .exr"
                ));
            }
        };
        if path.is_dir() {
            return usage(format!("--output {shown}: is a folder"));
        }
        let folder = folder_of(path);
        if !folder.is_dir() {
            return usage(format!(
                "--output {shown}: there is no folder {}; create it first",
                folder.display()
            ));
        }
        // Creating a file is the only test of permissions that means anything.
        if let Err(error) = Temporary::create(path) {
            return usage(format!(
                "--output {shown}: cannot write to {}: {error}",
                folder.display()
            ));
        }
        Ok(Self {
            path: path.to_owned(),
            format,
        })
    }

    /// Writes the picture and its planes; no file gets its name before all are complete and on
    /// disk. Returns what was written.
    ///
    /// # Errors
    /// [`AppError::Internal`] naming the file; nothing new is left behind.
    pub fn write(&self, picture: &Picture) -> Result<Vec<PathBuf>, AppError> {
        let mut files = Vec::new();
        match self.format {
            Format::Exr => files.push((self.path.clone(), encode_exr(picture))),
            Format::Png => {
                files.push((
                    self.path.clone(),
                    encode_png(picture.size, &picture.display),
                ));
                for plane in &picture.planes {
                    let png = encode_png(picture.size, &aov::view(plane));
                    files.push((self.beside(plane.name), png));
                }
            }
        }
        let mut finished = Vec::new();
        for (path, bytes) in files {
            let failed = |error: &dyn std::fmt::Display| {
                AppError::Internal(format!("cannot write {}: {error}", path.display()))
            };
            let bytes = bytes.map_err(|error| failed(&error))?;
            let temporary = Temporary::create(&path)
                .and_then(|temporary| temporary.fill(&bytes))
                .map_err(|error| failed(&error))?;
            finished.push((path, temporary));
        }
        let mut written = Vec::new();
        for (path, temporary) in finished {
            temporary.rename_to(&path).map_err(|error| {
                AppError::Internal(format!("cannot write {}: {error}", path.display()))
            })?;
            written.push(path);
        }
        Ok(written)
    }

    /// `out.png` and `depth` make `out.depth.png`.
    fn beside(&self, name: &str) -> PathBuf {
        self.path.with_extension(format!("{name}.png"))
    }
}

/// A file under a hidden name beside its goal; gone unless it is renamed.
struct Temporary {
    path: PathBuf,
    file: File,
    renamed: bool,
}

impl Temporary {
    fn create(goal: &Path) -> std::io::Result<Self> {
        let mut name = std::ffi::OsString::from(".");
        name.push(goal.file_name().unwrap_or_default());
        name.push(format!(".{}.tmp", std::process::id()));
        let path = folder_of(goal).join(name);
        // A leftover of a killed run may have this name; `create_new` never follows a link.
        let _ = fs::remove_file(&path);
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)?;
        Ok(Self {
            path,
            file,
            renamed: false,
        })
    }

    fn fill(mut self, bytes: &[u8]) -> std::io::Result<Self> {
        self.file.write_all(bytes)?;
        self.file.sync_all()?;
        Ok(self)
    }

    fn rename_to(mut self, goal: &Path) -> std::io::Result<()> {
        fs::rename(&self.path, goal)?;
        self.renamed = true;
        // The new name itself must survive a crash too; only Unix can sync a folder.
        if cfg!(unix) {
            File::open(folder_of(goal))?.sync_all()?;
        }
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // Nobody is left to tell, and the next run overwrites it.
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// RGBA to an opaque PNG.
///
/// # Errors
/// What the encoder says.
pub fn encode_png(size: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>, String> {
    let rgb: Vec<u8> = rgba
        .chunks_exact(4)
        .flat_map(|texel| [texel[0], texel[1], texel[2]])
        .collect();
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&rgb, size[0], size[1], ExtendedColorType::Rgb8)
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Linear color as R, G, B, A and every plane as `name.channel`, in one part: the layout that
/// most viewers understand.
fn encode_exr(picture: &Picture) -> Result<Vec<u8>, String> {
    let mut channels = SmallVec::new();
    for (index, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
        let values = picture.color.iter().skip(index).step_by(4).copied();
        channels.push(AnyChannel::new(name, FlatSamples::F32(values.collect())));
    }
    for plane in &picture.planes {
        for (index, channel) in plane.channels.iter().enumerate() {
            let name = format!("{}.{channel}", plane.name);
            channels.push(AnyChannel::new(name.as_str(), samples(plane, index)));
        }
    }
    let size = Vec2(picture.size[0] as usize, picture.size[1] as usize);
    // ZIP: lossless and understood everywhere.
    let layer = Layer::new(
        size,
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

fn samples(plane: &Plane, index: usize) -> FlatSamples {
    let stride = plane.channels.len();
    match &plane.data {
        PlaneData::F32(values) => {
            FlatSamples::F32(values.iter().skip(index).step_by(stride).copied().collect())
        }
        PlaneData::U32(values) => {
            FlatSamples::U32(values.iter().skip(index).step_by(stride).copied().collect())
        }
    }
}

#[cfg(test)]
#[path = "output_tests.rs"]
mod tests;
