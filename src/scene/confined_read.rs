//! Text files that a scene names: read only from the scene's folder and the folders below it.

use std::{
    fs,
    io::ErrorKind,
    path::{Component, Path, PathBuf},
};

use super::{
    dependencies::Dependencies,
    diagnostic::{Diagnostic, Span},
    suggest,
};
use reflet_base::files::{open_regular, read_at_most};

/// Words and limits for one kind of file, such as scene text or scripts.
#[derive(Debug)]
pub struct Kind {
    /// Name of the kind in messages, such as `scene text` or `a script`.
    pub one: &'static str,
    /// Advice on the folder that file names start from and on their extension.
    pub names: &'static str,
    /// Advice on the folders that such files may be in.
    pub inside: &'static str,
    /// Largest file size, MiB.
    pub most_mib: u64,
}

/// A file that was read.
#[derive(Debug)]
pub struct Found {
    /// Path as asked for: the folder joined with the name.
    pub path: PathBuf,
    /// Canonical path, with symbolic links resolved.
    pub real: PathBuf,
    /// Text of the file.
    pub text: String,
}

/// The reason why a file cannot be read.
#[derive(Debug)]
pub struct Problem {
    /// Message for the user.
    pub message: String,
    /// Advice on what to do; empty for none.
    pub help: &'static str,
    /// Place of the mistake, if it is inside the file.
    pub inside: Option<Span>,
    /// Whether the file does not exist.
    is_missing: bool,
}

impl Problem {
    /// A problem of the file as a whole.
    pub fn new(message: String, help: &'static str) -> Self {
        Self {
            message,
            help,
            inside: None,
            is_missing: false,
        }
    }
}

impl Problem {
    /// The problem as an error at its place in the file, else at `at`, where the file is named.
    pub fn at_name(self, name: &'static str, at: Span) -> Diagnostic {
        let error = match self.inside {
            Some(inside) => Diagnostic::at("not-utf8", inside, self.message)
                .related(at, "the file is named here"),
            None => Diagnostic::at(name, at, self.message),
        };
        error.help(self.help)
    }

    fn inside(at: Span) -> Self {
        Self {
            inside: Some(at),
            ..Self::new(String::new(), "")
        }
    }
}

/// Reads `file`, which may name a subfolder, from the first of `folders` that has it. Every path that is
/// tried is added to `dependencies`, once the name is known to be allowed.
///
/// # Errors
/// A name or a link that leads out of the folder, a file that is missing, too large or not UTF-8.
pub fn read(
    folders: &[PathBuf],
    file: &str,
    kind: &Kind,
    dependencies: &Dependencies,
) -> Result<Found, Problem> {
    let mut first = None;
    for folder in folders {
        match read_in(folder, file, kind, dependencies) {
            Err(problem) if problem.is_missing => first = first.or(Some(problem)),
            other => return other,
        }
    }
    let missing = || Problem::new(format!("{} is nowhere", suggest::text(file)), "");
    let mut problem = first.unwrap_or_else(missing);
    if let [_, assets @ ..] = folders
        && !assets.is_empty()
    {
        let looked: Vec<_> = assets
            .iter()
            .map(|f| format!("\"{}\"", f.display()))
            .collect();
        problem.message += &format!(", nor in {}", looked.join(", "));
    }
    Err(problem)
}

fn read_in(
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
        ErrorKind::NotFound => Problem {
            is_missing: true,
            ..missing("does not exist")
        },
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
        ..Problem::inside(Span::not_utf8(&path, &wrong))
    })?;
    Ok(Found { path, real, text })
}
