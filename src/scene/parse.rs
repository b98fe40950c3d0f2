//! Scene text to [`SceneDesc`]: TOML 1.1, walked with the position of every value, so that all
//! mistakes of a file are reported at once.

mod enum_values;
mod include;
mod key_recorder;
mod names;
mod params;
mod read;
mod report;
mod script;
mod set;
mod syntax;
mod table;
mod value;

use std::{cell::OnceCell, path::Path};

use toml::de::{DeTable, DeValue};

pub use self::key_recorder::{Form, KeyRecord, RecordedKeys, Rule, SectionRecord, VariantRecord};
use self::{
    include::Included,
    report::Report,
    syntax::Shadow,
    table::{Place, Table},
    value::Node,
};
use crate::files::{open_regular, read_at_most};

use super::{
    dependencies::Dependencies,
    desc::{Entry, ParamValue, SceneDesc},
    diagnostic::{Diagnostic, Span},
};

/// Largest scene file, bytes. Geometry belongs in glTF files.
pub const MOST_BYTES: u64 = 16 << 20;

/// What messages call an override in place of a file.
pub const OVERRIDE: &str = "--set";

/// The scene and warnings, or all messages, errors and warnings alike.
pub type Parsed = Result<(SceneDesc, Vec<Diagnostic>), Vec<Diagnostic>>;

/// Reads a scene file; `overrides` are `path=value` texts that are laid over it, as `--set` takes.
///
/// # Errors
/// As [`read`], then as [`parse`].
pub fn load(path: &Path, overrides: &[String]) -> Parsed {
    parse(&read(path)?, path, overrides)
}

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
            error.help = Some("check the path; it starts from the folder you are in".into());
        }
        vec![error]
    };
    if path.is_dir() {
        let message = "a folder was given where a scene file is expected";
        return Err(refuse("unreadable-file", message.into()));
    }
    let file = open_regular(path, false).map_err(unreadable)?;
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
        let error = Diagnostic::at("not-utf8", Span::not_utf8(path, &wrong), message);
        vec![error.help("save the file as UTF-8 in your editor")]
    })
}

/// Reads scene text. `path` is what messages call it, and its folder is where relative file names
/// start; `overrides` are `path=value` texts that are laid over it.
///
/// # Errors
/// All mistakes of the text, in its order, at most 100.
pub fn parse(text: &str, path: &Path, overrides: &[String]) -> Parsed {
    parse_traced(text, path, overrides, &Dependencies::default())
}

/// As [`parse`]; the included files and scripts that are looked for are added to `dependencies`, also when
/// it fails.
///
/// # Errors
/// As [`parse`].
pub fn parse_traced(
    text: &str,
    path: &Path,
    overrides: &[String],
    dependencies: &Dependencies,
) -> Parsed {
    let mut report = Report::default();
    report.add_source(path, text);
    let bases: Vec<_> = overrides
        .iter()
        .map(|o| report.add_source(Path::new(OVERRIDE), o))
        .collect();
    let scripted = OnceCell::new(); // before the tree, which borrows what a script adds
    let included = include::collect(text, path, dependencies, &mut report);
    let (mut root, shadows) = tree(text, &included, &mut report);
    for (text, base) in overrides.iter().zip(bases) {
        set::apply(&mut root, text, base, &mut report);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let nothing = DeTable::new();
    let scripted = scripted.get_or_init(|| match root.get_ref().as_table() {
        Some(table) if shadows.is_empty() => script::run(table, folder, dependencies, &mut report),
        _ => Default::default(),
    });
    script::merge(&mut root, scripted, &mut report);
    let table = root.get_ref().as_table().unwrap_or(&nothing);
    let mut scene =
        Table::read::<SceneDesc>(&mut report, table, Place::default()).unwrap_or_default();
    scene.folder = folder.to_owned();
    scene.script.clone_from(&scripted.script);
    if shadows.is_empty() {
        names::check(&scene, table, &included, &mut report);
    }
    // Those of included files are there to be used, and stand nowhere by themselves.
    let instances = &scene.instances;
    let is_used = |name: &str| instances.iter().any(|i| i.model.value == name);
    let is_wanted = |m: &Entry<_>| is_used(&m.name) || !included.has(&m.at);
    scene.models.retain(is_wanted);
    report.retain(|d| !shadows.iter().any(|s| s.hides(d)));
    if report.has("unsupported-version") {
        // In another version other keys may be right.
        report.retain(|d| d.name == "unsupported-version");
    }
    match report.finish() {
        (messages, false) => {
            scene.includes = included.into_files();
            Ok((scene, messages))
        }
        (messages, true) => Err(messages),
    }
}

/// A text with what it includes as one tree, and what their broken lines make doubtful.
fn tree<'i>(text: &'i str, included: &'i Included, report: &mut Report) -> (Node<'i>, Vec<Shadow>) {
    let (root, mut shadows) = syntax::parse(text, 0, report);
    let mut root = Node::new(root.span(), DeValue::Table(root.into_inner()));
    include::merge(&mut root, included, &mut shadows, report);
    (root, shadows)
}

/// The parameters that a text declares, with overrides as [`parse`] takes them; `None` where that
/// cannot be told. No script is run.
pub fn params(text: &str, path: &Path, overrides: &[String]) -> Option<Vec<Entry<ParamValue>>> {
    let mut report = Report::default();
    report.add_source(path, text);
    let included = include::collect(text, path, &Dependencies::default(), &mut report);
    let (mut root, _) = tree(text, &included, &mut report);
    for text in overrides {
        let base = report.add_source(Path::new(OVERRIDE), text);
        set::apply(&mut root, text, base, &mut report);
    }
    let table = root.get_ref().as_table()?.get("params");
    let params = table.map_or_else(
        || Some(Vec::new()),
        |table| Some(params::read(table.get_ref().as_table()?, &mut report)),
    );
    params.filter(|_| report.errors() == 0)
}

/// Every table and key that the readers ask for, the whole file first.
pub fn recorded_keys() -> RecordedKeys {
    let mut notes = RecordedKeys::default();
    Table::describe::<SceneDesc>(&mut notes);
    notes
}
