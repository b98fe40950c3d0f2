//! Syntax trees of scene text to [`SceneDesc`], walked with the position of every value, so that all mistakes of
//! a file are reported at once.

mod additions;
mod document;
pub mod entry_kinds;
mod extends;
mod hierarchy;
mod include;
mod layers;
mod names;
mod near_names;
mod overlay;
mod placed;
mod read;
mod rules;
mod set;
mod syntax_errors;
pub mod tables;

use std::{
    io::{Read as _, Seek as _},
    path::Path,
    sync::LazyLock,
};

pub use self::document::{Document, Texts};
pub use self::placed::{PlacedGroup, RanScript, Run, ScriptInput};
pub use self::read::read_project;
pub use crate::table::key_recorder::{
    Form, KeyRecord, RecordedKeys, Rule, SectionRecord, VariantRecord,
};
use crate::table::{Section, Table};
use reflet_base::{
    files::{open_regular, read_at_most},
    shell::shell_word,
};

use super::{
    desc::{ProjectDesc, SceneDesc},
    diagnostic::{Diagnostic, Span},
    reach::Border,
    suggest,
};

/// Largest scene file, bytes. Geometry belongs in glTF files.
pub const MOST_BYTES: u64 = 16 << 20;

/// Name of an override in messages, in place of a file name.
pub const OVERRIDE: &str = "--set";

/// Name of a chosen variant in messages, in place of a file name.
pub const VARIANT: &str = "--variant";

/// Options for reading a scene's text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// `path=value` texts that are laid over the scene, as `--set` takes.
    pub overrides: Vec<String>,
    /// Names of `[variant.NAME]` tables, laid over the scene before the overrides, in this order.
    pub variants: Vec<String>,
    /// Whether the tables of other variants are left out, so that reading one of many variants takes no longer than
    /// reading the scene.
    pub only_chosen: bool,
    /// Folders where bases, included files and scripts are looked for after the scene's own.
    pub border: Border,
}

impl From<&[String]> for ReadOptions {
    /// Overrides alone.
    fn from(overrides: &[String]) -> Self {
        Self {
            overrides: overrides.to_vec(),
            ..Self::default()
        }
    }
}

/// The description and warnings, or all messages, errors and warnings alike.
pub type Parsed = Result<(SceneDesc, Vec<Diagnostic>), Vec<Diagnostic>>;

/// The text of a scene file.
///
/// # Errors
/// One message about a file that cannot be read, is larger than [`MOST_BYTES`] or is not UTF-8.
pub fn read(path: &Path) -> Result<String, Vec<Diagnostic>> {
    let refuse = |name, message: String| vec![Diagnostic::in_file(name, path, message)];
    let unreadable = |e: std::io::Error| {
        let mut error =
            Diagnostic::in_file("unreadable-file", path, format!("cannot be read: {e}"));
        if e.kind() == std::io::ErrorKind::NotFound {
            error.message = "the scene file does not exist".into();
            let typed = path.file_name().unwrap_or_default().to_string_lossy();
            let names = scenes_in(path.parent().unwrap_or(Path::new("")));
            let meant = suggest::nearest(&typed, names.iter().map(String::as_str));
            error.help = Some(meant.map_or_else(
                || {
                    match path.to_string_lossy().contains("://") {
                        true => {
                            "a scene is a file of this machine: download it, and write its path"
                        }
                        false => "check the path; it starts from the folder you are in",
                    }
                    .into()
                },
                |meant| format!("did you mean {}?", suggest::text(meant)),
            ));
        }
        vec![error]
    };
    if path.is_dir() {
        let message = "a folder was given where a scene file is expected";
        let mut error = refuse("unreadable-file", message.into());
        let names: Vec<_> = (scenes_in(path).into_iter().take(MOST_NAMED))
            .map(|name| suggest::text(&path.join(name).to_string_lossy()))
            .collect();
        error[0].help = Some(match names.is_empty() {
            true => "write the name of a file that ends in `.toml`".to_owned(),
            false => format!("name one of its files, such as {}", names.join(", ")),
        });
        return Err(error);
    }
    let mut file = open_regular(path, false).map_err(unreadable)?;
    let mut begin = Vec::new();
    (&file)
        .take(4)
        .read_to_end(&mut begin)
        .map_err(unreadable)?;
    file.rewind().map_err(unreadable)?;
    if begin == b"PK\x03\x04" {
        let mut error = refuse("file-format", "this is a ZIP file, not a scene".into());
        let name = shell_word(&path.to_string_lossy());
        error[0].help = Some(format!(
            "`reflet unpack {name} -o FOLDER` unpacks a pack, and says how to render it"
        ));
        return Err(error);
    }
    let bytes = read_at_most(&file, MOST_BYTES).map_err(|error| {
        if error.kind() != std::io::ErrorKind::FileTooLarge {
            return unreadable(error);
        }
        let most = MOST_BYTES >> 20;
        let mut error = refuse(
            "file-too-large",
            format!("a scene may have at most {most} MiB"),
        );
        error[0].help = Some("geometry belongs in glTF files, named by `file`".into());
        error
    })?;
    String::from_utf8(bytes).map_err(|wrong| {
        let message = "a scene must be UTF-8 text, and this byte is not";
        let error = Diagnostic::new("not-utf8", Span::not_utf8(path, &wrong), message);
        let help = match image::guess_format(wrong.as_bytes()) {
            Ok(_) => "this is a picture: a scene shows it by `base_color_texture` of a material",
            Err(_) => "save the file as UTF-8 in your editor",
        };
        vec![error.help(help)]
    })
}

/// Largest number of scenes of a folder that a message names.
const MOST_NAMED: usize = 4;

/// Names of the files of a folder that may be scenes, sorted.
fn scenes_in(folder: &Path) -> Vec<String> {
    let folder = if folder == Path::new("") {
        Path::new(".")
    } else {
        folder
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let is_scene = |name: &String| name.ends_with(".toml") && name != "reflet.toml";
    let mut names: Vec<_> = names.take(suggest::MOST_NAMES).filter(is_scene).collect();
    names.sort();
    names
}

static SCENE: LazyLock<Vec<SectionRecord>> = LazyLock::new(record::<SceneDesc>);
static PROJECT: LazyLock<Vec<SectionRecord>> = LazyLock::new(record::<ProjectDesc>);

fn record<T: Section>() -> Vec<SectionRecord> {
    let mut notes = RecordedKeys::default();
    Table::describe::<T>(&mut notes);
    notes.sections
}

/// Every table and key that the readers of a scene ask for, the whole file first.
pub fn recorded_keys() -> &'static [SectionRecord] {
    &SCENE
}

/// Every table and key that the reader of a project asks for.
pub fn recorded_project_keys() -> &'static [SectionRecord] {
    &PROJECT
}
