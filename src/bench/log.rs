//! Table of samples, to which a run appends: in memory, and on disk where it has a file.

#[cfg(not(target_arch = "wasm32"))]
mod on_disk;

use std::{
    collections::HashMap,
    fs::File,
    io::Write as _,
    path::{Path, PathBuf},
};

use super::sample::Sample;
use reflet_metric::file_error;
use reflet_scene::diagnostic::Diagnostic;

#[cfg(not(target_arch = "wasm32"))]
pub use on_disk::read;

/// An open table of samples: a file that is locked against other runs while this lives, by default one in memory.
#[derive(Debug, Default)]
pub struct Log {
    path: PathBuf,
    /// File of the table; none of a table in memory.
    file: Option<File>,
    samples: Vec<Sample>,
    /// Measured repetitions by fingerprint.
    known: HashMap<String, Vec<u32>>,
    /// Whether the last line was cut off when the table was opened, and is removed.
    pub was_torn: bool,
}

impl Log {
    /// Appends a sample and flushes it.
    ///
    /// # Errors
    /// A full disk or a lost folder.
    pub fn append(&mut self, sample: Sample) -> Result<(), Box<Diagnostic>> {
        self.write(&sample.line())?;
        self.keep(sample);
        Ok(())
    }

    /// Whether the table holds this repetition of a setting.
    pub fn has(&self, fingerprint: &str, repetition: u32) -> bool {
        let known = self.known.get(fingerprint);
        known.is_some_and(|repetitions| repetitions.contains(&repetition))
    }

    /// All samples, earlier runs' included.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    fn keep(&mut self, sample: Sample) {
        let known = self.known.entry(sample.fingerprint.clone()).or_default();
        known.push(sample.repetition);
        self.samples.push(sample);
    }

    /// One write per line, so that a reader sees whole lines.
    fn write(&mut self, line: &str) -> Result<(), Box<Diagnostic>> {
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        file.write_all(line.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|e| unwritable(&self.path, &e))
    }
}

fn unwritable(path: &Path, error: &std::io::Error) -> Box<Diagnostic> {
    let message = format!("cannot be written: {error}");
    let help = "choose a folder that can be written to with -o";
    file_error("unwritable-samples", path, message, help)
}
