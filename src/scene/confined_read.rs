//! Text files and fonts that a scene names: read only from its folder and the folders below it, and inside its project.

use std::{
    io::ErrorKind,
    path::{Component, Path, PathBuf},
};

use super::{
    dependencies::Dependencies,
    diagnostic::{Diagnostic, Span},
    reach::{Reach, lexical},
    suggest,
};
use reflet_base::files::{canonicalize, open_regular, read_at_most, similar};

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

/// Advice on names that climb out of the scene's folder.
const IN_PROJECT: &str = "a project (`reflet.toml` in a folder above the scene, see `reflet new`) lets names begin with \
                          `../` inside of its folder";

/// A file that was read, as text or as bytes.
#[derive(Debug)]
pub struct Found<T = String> {
    /// Path as asked for: the folder joined with the name.
    pub path: PathBuf,
    /// Canonical path, with symbolic links resolved.
    pub real: PathBuf,
    /// Text or bytes of the file.
    pub data: T,
}

/// The reason why a file cannot be read.
#[derive(Debug)]
pub struct Problem {
    /// Message for the user.
    pub message: String,
    /// Advice on what to do; empty for none.
    pub help: String,
    /// Place of the mistake, if it is inside the file.
    pub inside: Option<Span>,
    /// Whether the file does not exist.
    is_missing: bool,
}

impl Problem {
    /// A problem of the file as a whole.
    pub fn new(message: String, help: impl Into<String>) -> Self {
        Self {
            message,
            help: help.into(),
            inside: None,
            is_missing: false,
        }
    }

    /// The problem, or where the file does not exist another one that is made of it.
    pub fn or_missing(self, missing: impl FnOnce(Self) -> Self) -> Self {
        match self.is_missing {
            true => missing(self),
            false => self,
        }
    }

    /// The problem as an error at its place in the file, else at `at`, where the file is named.
    pub fn at_name(self, name: &'static str, at: Span) -> Diagnostic {
        let error = match self.inside {
            Some(inside) => Diagnostic::new("not-utf8", inside, self.message)
                .related(at, "the file is named here"),
            None => Diagnostic::new(name, at, self.message),
        };
        error.help(self.help)
    }
}

/// Reads `file`, which may name a subfolder, from the first of the folders that has it. Every path that is
/// tried is added to `dependencies`, once the name is known to be allowed.
///
/// # Errors
/// A name or a link that leads out of the folder and of the project, a file that is missing, too large or not UTF-8.
pub fn read(
    reach: &Reach,
    file: &str,
    kind: &Kind,
    dependencies: &Dependencies,
) -> Result<Found, Problem> {
    let Found { path, real, data } = read_bytes(reach, file, kind, dependencies)?;
    let data = String::from_utf8(data).map_err(|wrong| Problem {
        inside: Some(Span::not_utf8(&path, &wrong)),
        ..Problem::new(
            format!("{} must be UTF-8 text, and this byte is not", kind.one),
            "save the file as UTF-8 in your editor",
        )
    })?;
    Ok(Found { path, real, data })
}

/// The same as [`read`], for a file of any bytes.
///
/// # Errors
/// Same errors as [`read`].
pub fn read_bytes(
    reach: &Reach,
    file: &str,
    kind: &Kind,
    dependencies: &Dependencies,
) -> Result<Found<Vec<u8>>, Problem> {
    let mut first = None;
    for folder in reach.folders() {
        match read_in(reach, folder, file, kind, dependencies) {
            Err(problem) if problem.is_missing => first = first.or(Some(problem)),
            // A name that climbs is most likely meant from the scene's own folder.
            Err(_) if first.is_some() && climbs(file) => {}
            other => return other,
        }
    }
    let missing = || Problem::new(format!("{} is nowhere", suggest::text(file)), "");
    let mut problem = first.unwrap_or_else(missing);
    if let [_, assets @ ..] = reach.folders()
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

/// Problem of a name that leads out of the project.
fn out_of_project(shown: &str, reach: &Reach) -> Problem {
    let project = reach.project().unwrap_or(Path::new("")).display();
    let message = format!("{shown} leads out of the project, whose folder is \"{project}\"");
    let help = "move the file into the project, or name its folder by --assets DIR";
    Problem::new(message, help)
}

/// Whether a name has a part `..`.
fn climbs(file: &str) -> bool {
    Path::new(file)
        .components()
        .any(|part| part == Component::ParentDir)
}

fn read_in(
    reach: &Reach,
    folder: &Path,
    file: &str,
    kind: &Kind,
    dependencies: &Dependencies,
) -> Result<Found<Vec<u8>>, Problem> {
    let shown = suggest::text(file);
    let relative = Path::new(file);
    let path = folder.join(relative);
    let names = match file {
        _ if file.contains(['{', '\n']) => {
            "this is a text itself: write it into a file of its own, and here the name of that file, such as \
             \"scene.rhai\""
        }
        _ if file.contains('*') => {
            "patterns of names are not expanded: write each name, as in `[\"a.toml\", \"b.toml\"]`"
        }
        _ if file.starts_with('~') => {
            "`~` is not expanded: write the name of the file, and its folder with --assets DIR"
        }
        _ => kind.names,
    };
    let missing = |what: &str| Problem::new(format!("\"{}\" {what}", path.display()), names);
    let plain = relative
        .components()
        .all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    let climbs = climbs(file) && reach.project().is_some();
    if !(plain || climbs) || file.is_empty() || file.contains('\\') {
        let message = format!("{shown} is not below the scene's folder");
        let help = match plain {
            true => kind.inside.to_owned(),
            false => format!("{}; {IN_PROJECT}", kind.inside),
        };
        return Err(Problem::new(message, help));
    }
    let root = canonicalize(Path::new(".").join(folder));
    let root = match root {
        // Nothing outside of the project is looked at.
        Ok(root) if climbs => {
            let inside = lexical(&root, relative).filter(|path| reach.holds(path, &root));
            inside.ok_or_else(|| out_of_project(&shown, reach))?;
            Ok(root)
        }
        root => root,
    };
    dependencies.add(path.clone());
    let real = canonicalize(&path).map_err(|e| match e.kind() {
        ErrorKind::NotFound => Problem {
            is_missing: true,
            help: match similar(&Path::new(".").join(folder), relative) {
                Some(name) => format!("it is there as \"{}\"", name.display()),
                None => names.to_owned(),
            },
            ..missing("does not exist")
        },
        _ => missing(&format!("cannot be read: {e}")),
    })?;
    let root = root.map_err(|e| missing(&format!("cannot be read: {e}")))?;
    if !reach.holds(&real, &root) {
        let message = format!("{shown} resolves to a file outside the scene's folder");
        return Err(match reach.project() {
            Some(_) => out_of_project(&shown, reach),
            None => Problem::new(message, kind.inside),
        });
    }
    if let Some(text) = reach.unsaved().text(&real) {
        let data = text.as_bytes().to_vec();
        return Ok(Found { path, real, data });
    }
    let file = open_regular(&real, false);
    let bytes = file.and_then(|file| read_at_most(&file, kind.most_mib << 20));
    let data = bytes.map_err(|e| {
        let message = format!("\"{}\" cannot be read: {e}", path.display());
        Problem::new(message, "")
    })?;
    Ok(Found { path, real, data })
}
