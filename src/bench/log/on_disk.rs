//! Tables of samples as files: each sample is appended and flushed at once; `--resume` reads it.

use std::{
    fs::{File, OpenOptions, TryLockError},
    io,
    path::Path,
};

use super::{Log, unwritable};
use crate::sample::{Sample, header, read_samples};
use reflet_base::files::{folder_of, open_regular, read_at_most};
use reflet_metric::file_error;
use reflet_scene::diagnostic::Diagnostic;

/// Largest size of a table that is read, bytes: about a million samples.
const MAX_TABLE_BYTES: u64 = 1 << 30;

impl Log {
    /// Starts a new table.
    ///
    /// # Errors
    /// When the file exists already or cannot be created.
    pub fn create(path: &Path) -> Result<Self, Box<Diagnostic>> {
        if path.exists() {
            return Err(file_error(
                "samples-exist",
                path,
                "this table of samples exists already",
                "add --resume to measure only what it lacks, or choose another folder with -o",
            ));
        }
        let mut options = OpenOptions::new();
        let file = options.read(true).append(true).create_new(true).open(path);
        let file = file.map_err(|e| unwritable(path, &e))?;
        lock(path, &file)?;
        Self::start(path, file)
    }

    fn start(path: &Path, file: File) -> Result<Self, Box<Diagnostic>> {
        let mut log = Self::opened(path, file, false);
        log.write(&header())?;
        Ok(log)
    }

    fn opened(path: &Path, file: File, was_torn: bool) -> Self {
        Self {
            path: path.to_owned(),
            file: Some(file),
            was_torn,
            ..Self::default()
        }
    }

    /// Opens a table to append to; creates it where there is none. Removes a last line that was cut off.
    ///
    /// # Errors
    /// When the file cannot be read or written, is no table of samples, has other columns, or
    /// another run writes to it.
    pub fn resume(path: &Path) -> Result<Self, Box<Diagnostic>> {
        let file = match open_regular(path, true) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Self::create(path),
            opened => opened.map_err(|e| unwritable(path, &e))?,
        };
        lock(path, &file)?;
        let text = text_of(path, &file)?;
        if !text.contains('\n') && header().starts_with(&text) {
            // The last run stopped before its header was written: nothing is lost.
            file.set_len(0).map_err(|e| unwritable(path, &e))?;
            return Self::start(path, file);
        }
        let (samples, whole_bytes) = parse(path, &text)?;
        if text.lines().next().map(|line| line.to_owned() + "\n") != Some(header()) {
            return Err(file_error(
                "other-columns",
                path,
                "this table was written by another version, which has other columns",
                "measure into another folder with -o",
            ));
        }
        file.set_len(whole_bytes as u64)
            .map_err(|e| unwritable(path, &e))?;
        let mut log = Self::opened(path, file, whole_bytes < text.len());
        samples.into_iter().for_each(|sample| log.keep(sample));
        Ok(log)
    }
}

/// Reads the samples of a file, and returns whether a last line that was cut off is left out.
///
/// # Errors
/// A file that cannot be read, is no table of samples, or holds none.
pub fn read(path: &Path) -> Result<(Vec<Sample>, bool), Box<Diagnostic>> {
    let file = open_regular(path, false).map_err(|e| unreadable(path, &e))?;
    let text = text_of(path, &file)?;
    let (samples, whole_bytes) = parse(path, &text)?;
    if samples.is_empty() {
        let message = "this table holds no samples";
        let help = "measure some with `reflet bench`";
        return Err(file_error("no-samples", path, message, help));
    }
    Ok((samples, whole_bytes < text.len()))
}

/// Locks the file, because two runs that append to one table would measure the same frames.
fn lock(path: &Path, file: &File) -> Result<(), Box<Diagnostic>> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(file_error(
            "samples-in-use",
            path,
            format!(
                "another run measures into the folder {}",
                folder_of(path).display()
            ),
            "wait until it ends, or choose another folder with -o",
        )),
        // Some network file systems have no locks; runs there are not protected from each other.
        Err(TryLockError::Error(e)) if e.kind() == io::ErrorKind::Unsupported => Ok(()),
        Err(TryLockError::Error(e)) => Err(unwritable(path, &e)),
    }
}

fn text_of(path: &Path, file: &File) -> Result<String, Box<Diagnostic>> {
    let bytes = read_at_most(file, MAX_TABLE_BYTES).map_err(|e| unreadable(path, &e))?;
    let invalid = |e| unreadable(path, &io::Error::new(io::ErrorKind::InvalidData, e));
    String::from_utf8(bytes).map_err(invalid)
}

fn parse(path: &Path, text: &str) -> Result<(Vec<Sample>, usize), Box<Diagnostic>> {
    read_samples(text).map_err(|error| {
        let help = "it must be a samples.csv as `reflet bench` writes it";
        file_error("bad-samples", path, error.to_string(), help)
    })
}

fn unreadable(path: &Path, error: &std::io::Error) -> Box<Diagnostic> {
    let message = format!("cannot be read: {error}");
    file_error("unreadable-samples", path, message, "check the path")
}
