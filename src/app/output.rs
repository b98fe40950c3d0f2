//! Picture files: PNG and EXR, written so that a file is there whole or not at all.

use std::{
    fs::{self, File},
    io::{self, BufReader, Cursor},
    path::{Path, PathBuf},
};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec, Text,
    Vec2, WritableImage as _, attribute::AttributeValue, read_first_flat_layer_from_file,
};
use xxhash_rust::xxh3::Xxh3Default;

use super::{aov, error::AppError, film, fingerprint::KEYWORD};
use crate::{
    files::{Temporary, folder_of, write_together},
    render::{Picture, Plane, PlaneData, aov::Aov},
};

/// Name under which an EXR carries the hash of its samples.
const SAMPLES: &str = "reflet-samples";

/// What an output file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// 8 bits, tone-mapped.
    Png,
    /// Linear 32-bit floats, with intermediate pictures as layers.
    Exr,
}

impl Format {
    /// What a name's ending says.
    fn of(path: &Path) -> Result<Self, AppError> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(AppError::Usage(format!(
                "--output {}: the name must end in .png or .exr, or for a film in {}",
                path.display(),
                film::endings()
            ))),
        }
    }
}

/// Checks the ending of a picture's name alone.
///
/// # Errors
/// [`AppError::Usage`] with the endings that there are.
pub fn check_ending(path: &Path) -> Result<(), AppError> {
    Format::of(path).map(drop)
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
        let format = Format::of(path)?;
        check_writable(path)?;
        Ok(Self {
            path: path.to_owned(),
            format,
        })
    }

    /// Whether it holds linear color.
    pub fn has_color(&self) -> bool {
        self.format == Format::Exr
    }

    /// Checks the files beside a PNG too, one for each of these AOVs.
    ///
    /// # Errors
    /// As [`Output::new`].
    pub fn check_beside(&self, aovs: &[Aov]) -> Result<(), AppError> {
        match self.format {
            Format::Png => aovs
                .iter()
                .try_for_each(|aov| check_writable(&self.beside(aov.name()))),
            Format::Exr => Ok(()),
        }
    }

    /// Writes the picture and its planes; no file gets its name before all are complete and on
    /// disk. Returns what was written.
    ///
    /// # Errors
    /// [`AppError::Disk`] or [`AppError::Internal`] naming the file; nothing new is left behind.
    pub fn write(&self, picture: &Picture) -> Result<Vec<PathBuf>, AppError> {
        self.write_marked(picture, None)
    }

    /// The same with a fingerprint in every file.
    ///
    /// # Errors
    /// As [`Output::write`].
    pub fn write_marked(
        &self,
        picture: &Picture,
        mark: Option<&str>,
    ) -> Result<Vec<PathBuf>, AppError> {
        let mut files = Vec::new();
        match self.format {
            Format::Exr => files.push((self.path.clone(), encode_exr(picture, mark))),
            Format::Png => {
                files.push((
                    self.path.clone(),
                    encode_png(picture.size, &picture.display, mark),
                ));
                for plane in &picture.planes {
                    let png = encode_png(picture.size, &aov::view(plane), mark);
                    files.push((self.beside(plane.name), png));
                }
            }
        }
        let encoded = files.into_iter().map(|(path, bytes)| match bytes {
            Ok(bytes) => Ok((path, bytes)),
            Err(error) => Err(AppError::Internal(format!(
                "cannot write {}: {error}",
                path.display()
            ))),
        });
        let encoded = encoded.collect::<Result<Vec<_>, _>>()?;
        write_together(&encoded).map_err(|(path, error)| AppError::unwritten(&path, &error))?;
        Ok(encoded.into_iter().map(|(path, _)| path).collect())
    }

    /// The same kind of file under another name beside it, which is not checked again.
    pub fn renamed(&self, path: PathBuf) -> Self {
        Self {
            path,
            format: self.format,
        }
    }

    /// The files of a picture with these planes.
    pub fn files(&self, planes: &[&str]) -> Vec<PathBuf> {
        let beside = match self.format {
            Format::Png => planes,
            Format::Exr => &[],
        };
        let beside = beside.iter().map(|name| self.beside(name));
        std::iter::once(self.path.clone()).chain(beside).collect()
    }

    /// Whether all of them are there, whole and with this fingerprint.
    pub fn is_done(&self, planes: &[&str], mark: &str) -> bool {
        let found = match self.format {
            Format::Png => png_mark,
            Format::Exr => exr_mark,
        };
        let files = self.files(planes);
        files
            .iter()
            .all(|path| found(path).as_deref() == Some(mark))
    }

    /// `out.png` and `depth` make `out.depth.png`.
    fn beside(&self, name: &str) -> PathBuf {
        self.path.with_extension(format!("{name}.png"))
    }
}

/// Checks that a file can be created, before any time is spent on rendering it.
///
/// # Errors
/// [`AppError::Usage`] saying which part of the path is wrong.
pub fn check_writable(path: &Path) -> Result<(), AppError> {
    let shown = path.display();
    let usage = |text: String| Err(AppError::Usage(text));
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
    // The hidden name that files are written under may be shorter than this one.
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return usage(format!("--output {shown}: {error}"));
        }
        _ => {}
    }
    // Creating a file is the only test of permissions that means anything.
    if let Err(error) = Temporary::create(path) {
        return usage(format!(
            "--output {shown}: cannot write to {}: {error}",
            folder.display()
        ));
    }
    Ok(())
}

/// RGBA to an opaque PNG; `mark` is kept in it as text.
///
/// # Errors
/// What the encoder says.
pub fn encode_png(size: [u32; 2], rgba: &[u8], mark: Option<&str>) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let written = mark
        .map_or(Ok(()), |mark| {
            encoder.add_text_chunk(KEYWORD.to_owned(), mark.to_owned())
        })
        .and_then(|()| encoder.write_header())
        .and_then(|mut writer| {
            writer.write_image_data(&rgb(rgba))?;
            writer.finish()
        });
    written.map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Without alpha, which display colors do not have.
pub fn rgb(rgba: &[u8]) -> Vec<u8> {
    let texels = rgba.chunks_exact(4);
    texels.flat_map(|t| [t[0], t[1], t[2]]).collect()
}

/// The fingerprint in a PNG that ends as PNGs do.
fn png_mark(path: &Path) -> Option<String> {
    let file = BufReader::new(File::open(path).ok()?);
    let mut reader = png::Decoder::new(file).read_info().ok()?;
    let mut pixels = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut pixels).ok()?;
    reader.finish().ok()?;
    let texts = &reader.info().uncompressed_latin1_text;
    let found = texts.iter().find(|chunk| chunk.keyword == KEYWORD);
    found.map(|chunk| chunk.text.clone())
}

/// The fingerprint in an EXR whose samples are those that were written.
fn exr_mark(path: &Path) -> Option<String> {
    let layer = read_first_flat_layer_from_file(path).ok()?.layer_data;
    let text = |key| match layer.attributes.other.get(&Text::from(key))? {
        AttributeValue::Text(text) => Some(text.to_string()),
        _ => None,
    };
    let is_whole = text(SAMPLES)? == hash_of(&layer.channel_data);
    text(KEYWORD).filter(|_| is_whole)
}

/// Hash of all samples, in hexadecimal digits: EXR itself has no checksum.
fn hash_of(channels: &AnyChannels<FlatSamples>) -> String {
    let mut hash = Xxh3Default::new();
    for channel in &channels.list {
        match &channel.sample_data {
            FlatSamples::F32(all) => all.iter().for_each(|v| hash.update(&v.to_le_bytes())),
            FlatSamples::U32(all) => all.iter().for_each(|v| hash.update(&v.to_le_bytes())),
            FlatSamples::F16(all) => all.iter().for_each(|v| hash.update(&v.to_le_bytes())),
        }
    }
    format!("{:032x}", hash.digest128())
}

/// Linear color as R, G, B, A and every plane as `name.channel`, in one part: the layout that
/// most viewers understand.
fn encode_exr(picture: &Picture, mark: Option<&str>) -> Result<Vec<u8>, String> {
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
    let channels = AnyChannels::sort(channels);
    let mut attributes = LayerAttributes::default();
    if let Some(mark) = mark {
        let text = AttributeValue::Text(Text::from(mark));
        attributes.other.insert(Text::from(KEYWORD), text);
        let samples = AttributeValue::Text(Text::from(hash_of(&channels).as_str()));
        attributes.other.insert(Text::from(SAMPLES), samples);
    }
    // ZIP: lossless and understood everywhere.
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
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
