//! Text files that a scene names: read only from the scene's folder and the folders below it.

use std::{
    fs,
    io::ErrorKind,
    path::{Component, Path, PathBuf},
};

use super::{dependencies::Dependencies, diagnostic::Span, suggest};
use crate::files::{open_regular, read_at_most};

/// What messages say about files of a kind.
#[derive(Debug)]
pub struct Kind {
    /// One of them, with its article.
    pub one: &'static str,
    /// Where their names start and how they end.
    pub names: &'static str,
    /// From where they are read.
    pub inside: &'static str,
    /// Largest size, MiB.
    pub most_mib: u64,
}

/// A file that was read.
#[derive(Debug)]
pub struct Found {
    /// The folder and the name that was asked for.
    pub path: PathBuf,
    /// The same without links.
    pub real: PathBuf,
    /// Its text.
    pub text: String,
}

/// Why a file cannot be read.
#[derive(Debug)]
pub struct Problem {
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: &'static str,
    /// Where in the file, if it is there.
    pub inside: Option<Span>,
}

impl Problem {
    /// Of the file as a whole.
    pub fn new(message: String, help: &'static str) -> Self {
        Self {
            message,
            help,
            inside: None,
        }
    }
}

/// Reads `file` from `folder` or a folder below it; it is added to `dependencies` once its name is allowed.
///
/// # Errors
/// A name or a link that leads out of the folder, a file that is missing, too large or not UTF-8.
pub fn read(
    folder: &Path,
    file: &str,
    kind: &Kind,
    dependencies: &Dependencies,
) -> Result<Found, Problem> {
    let shown = suggest::text(file);
    let relative = Path::new(file);
    let plain = relative
        .components()
        .all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if !plain || file.is_empty() || file.contains('\\') {
        let message = format!("{shown} is not below the scene's folder");
        return Err(Problem::new(message, kind.inside));
    }
    let path = folder.join(relative);
    dependencies.add(path.clone());
    let missing = |what: &str| Problem::new(format!("\"{}\" {what}", path.display()), kind.names);
    let real = fs::canonicalize(&path).map_err(|e| match e.kind() {
        ErrorKind::NotFound => missing("does not exist"),
        _ => missing(&format!("cannot be read: {e}")),
    })?;
    let root = fs::canonicalize(Path::new(".").join(folder))
        .map_err(|e| missing(&format!("cannot be read: {e}")))?;
    if !real.starts_with(&root) {
        let message = format!("{shown} resolves to a file outside the scene's folder");
        return Err(Problem::new(message, kind.inside));
    }
    let file = open_regular(&real, false);
    let bytes = file.and_then(|file| read_at_most(&file, kind.most_mib << 20));
    let bytes = bytes.map_err(|e| {
        let message = format!("\"{}\" cannot be read: {e}", path.display());
        Problem::new(message, "")
    })?;
    let text = String::from_utf8(bytes).map_err(|wrong| Problem {
        message: format!("{} must be UTF-8 text, and this byte is not", kind.one),
        help: "save the file as UTF-8 in your editor",
        inside: Some(Span::not_utf8(&path, &wrong)),
    })?;
    Ok(Found { path, real, text })
}
