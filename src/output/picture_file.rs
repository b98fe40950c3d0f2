//! Picture files with the PNG files of their AOVs, written atomically.

use std::borrow::Cow;

use super::{
    exr,
    format::{Format, PictureFormat},
    writable::{check_replaceable, check_writable},
};
use crate::error::OutputError;
use reflet_base::files::{Goal, Inputs, write_together};
use reflet_render::{
    Picture,
    picture::{
        aov::Aov,
        aov_view,
        png_file::{self, FINGERPRINT_KEY, PngText, SAMPLES_KEY},
    },
};

/// An output path that was writable at the start of the command.
#[derive(Clone, Debug)]
pub struct PictureFile {
    path: Goal,
    format: PictureFormat,
}

impl PictureFile {
    /// Checks extension and folder before rendering.
    ///
    /// # Errors
    /// [`OutputError::Usage`] with the invalid part of the path.
    pub fn new(path: &Goal) -> Result<Self, OutputError> {
        let file = Self::unchecked(path)?;
        check_writable(path, &Inputs::default())?;
        Ok(file)
    }

    /// Checks the extension alone.
    ///
    /// # Errors
    /// [`OutputError::Usage`] with the extension.
    pub fn unchecked(path: &Goal) -> Result<Self, OutputError> {
        let format = match Format::from_path(path) {
            Some(Format::Picture(format)) => format,
            other => {
                let film = match other {
                    Some(Format::Film(film)) => {
                        format!(", not in .{}, which is a film", film.ending)
                    }
                    _ => String::new(),
                };
                return Err(OutputError::Usage(format!(
                    "--output {}: the name of a picture must end in .png or .exr{film}",
                    path.display()
                )));
            }
        };
        Ok(Self {
            path: path.clone(),
            format,
        })
    }

    /// Whether the file holds linear color.
    pub fn has_color(&self) -> bool {
        self.format == PictureFormat::Exr
    }

    /// Checks all files of a picture with these AOVs, and that none replaces one of the `inputs`.
    ///
    /// # Errors
    /// Same errors as [`check_replaceable`].
    pub fn check_files(&self, aovs: &[Aov], inputs: &Inputs) -> Result<(), OutputError> {
        let planes: Vec<_> = aovs.iter().map(|aov| aov.plane_name()).collect();
        let files = self.files(&planes);
        files
            .iter()
            .try_for_each(|file| check_replaceable(file, inputs))
    }

    /// Writes the picture and its planes, each with its number of sub-frames; files are renamed once all are complete
    /// and synced. Returns their paths.
    ///
    /// # Errors
    /// [`OutputError::Disk`] or [`OutputError::Internal`] naming the file; nothing new is left behind.
    pub fn write(&self, picture: &Picture) -> Result<Vec<Goal>, OutputError> {
        self.write_marked(picture, None)
    }

    /// Writes the picture and its planes with a fingerprint in every file.
    ///
    /// # Errors
    /// Same errors as [`PictureFile::write`].
    pub fn write_marked(
        &self,
        picture: &Picture,
        mark: Option<&str>,
    ) -> Result<Vec<Goal>, OutputError> {
        let encoded = self.encode(picture, mark)?;
        write_together(&encoded).map_err(|(path, error)| OutputError::unwritten(&path, &error))?;
        Ok(encoded.into_iter().map(|(path, _)| path).collect())
    }

    /// Contents of the files of a picture.
    ///
    /// # Errors
    /// [`OutputError::Internal`] naming the file.
    pub fn encode(
        &self,
        picture: &Picture,
        mark: Option<&str>,
    ) -> Result<Vec<(Goal, Vec<u8>)>, OutputError> {
        let mut files = Vec::new();
        let samples = picture.stats.samples.to_string();
        let mark = mark.map(|mark| (FINGERPRINT_KEY, mark));
        let texts: Vec<PngText> = [(SAMPLES_KEY, samples.as_str())]
            .into_iter()
            .chain(mark)
            .collect();
        match self.format {
            PictureFormat::Exr => files.push((
                self.path.clone(),
                exr::encode(picture, mark.map(|(_, mark)| mark)),
            )),
            PictureFormat::Png => {
                let encode = if picture.alpha {
                    png_file::encode_with_alpha
                } else {
                    png_file::encode
                };
                let bytes = encode(picture.size, &picture.display, &texts);
                files.push((self.path.clone(), bytes));
                for plane in &picture.planes {
                    let png = png_file::encode(picture.size, &aov_view::view(plane), &texts);
                    files.push((self.beside(&plane.name), png));
                }
            }
        }
        let encoded = files.into_iter().map(|(path, bytes)| match bytes {
            Ok(bytes) => Ok((path, bytes)),
            Err(error) => Err(OutputError::Internal(format!(
                "cannot write {}: {error}",
                path.display()
            ))),
        });
        encoded.collect()
    }

    /// File of the same kind with another name, unchecked.
    pub fn renamed(&self, path: Goal) -> Self {
        Self {
            path,
            format: self.format,
        }
    }

    /// The files of a picture with these planes.
    pub fn files(&self, planes: &[Cow<'static, str>]) -> Vec<Goal> {
        let beside = match self.format {
            PictureFormat::Png => planes,
            PictureFormat::Exr => &[],
        };
        let beside = beside.iter().map(|name| self.beside(name));
        std::iter::once(self.path.clone()).chain(beside).collect()
    }

    /// Whether all files of the picture exist, complete and with this fingerprint.
    pub fn is_done(&self, planes: &[Cow<'static, str>], mark: &str) -> bool {
        let found = match self.format {
            PictureFormat::Png => png_file::fingerprint,
            PictureFormat::Exr => exr::fingerprint,
        };
        let files = self.files(planes);
        files
            .iter()
            .all(|path| found(path).as_deref() == Some(mark))
    }

    /// `out.png` and `depth` give `out.depth.png`.
    fn beside(&self, name: &str) -> Goal {
        let path = self.path.with_extension(format!("{name}.png"));
        self.path.renamed(path)
    }
}
