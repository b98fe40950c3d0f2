//! Picture files: PNG and EXR, written so that a file is there whole or not at all.

use std::{
    fs::File,
    io::{BufReader, Cursor},
    path::{Path, PathBuf},
};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, MetaData,
    SmallVec, Text, Vec2, WritableImage as _, attribute::AttributeValue,
};

use super::{aov, error::AppError, film, fingerprint::KEYWORD};
use crate::{
    files::{Temporary, folder_of, write_together},
    render::{Picture, Plane, PlaneData, aov::Aov},
};

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
                    "--output {shown}: the name must end in .png or .exr, or for a film in {}",
                    film::endings()
                ));
            }
        };
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

/// The fingerprint in an EXR whose table of contents is complete.
fn exr_mark(path: &Path) -> Option<String> {
    let meta = MetaData::read_from_file(path, false).ok()?;
    let own = &meta.headers.first()?.own_attributes.other;
    match own.get(&Text::from(KEYWORD))? {
        AttributeValue::Text(text) => Some(text.to_string()),
        _ => None,
    }
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
    // ZIP: lossless and understood everywhere.
    let mut attributes = LayerAttributes::default();
    if let Some(mark) = mark {
        let text = AttributeValue::Text(Text::from(mark));
        attributes.other.insert(Text::from(KEYWORD), text);
    }
    let layer = Layer::new(
        size,
        attributes,
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
