//! `include = [...]`: files of scene text that are merged with the scene's own, so that several scenes
//! share materials, models or lights.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
    sync::Arc,
};

use toml::{
    Spanned,
    de::{DeString, DeTable, DeValue},
};

use super::{
    MOST_BYTES,
    report::Report,
    set::shift,
    syntax,
    syntax::Shadow,
    value::{Named, Names, Node, Value as _, Version},
};
use crate::scene::{
    confined_read::{self, Kind},
    dependencies::Dependencies,
    desc::{At, Include},
    diagnostic::{Diagnostic, Source, Span},
    range::ANY,
    suggest,
};

/// Largest number of included files of a scene, nested ones too.
const MOST: usize = 100;

/// Words for included scene text in messages.
const SCENES: Kind = Kind {
    one: "scene text",
    names: "names of included files start from the scene's folder or an asset folder (--assets DIR)",
    inside: "included files are read only from the scene's folder, asset folders, and the folders \
             below",
    most_mib: MOST_BYTES >> 20,
};

/// Included files, with the positions where their texts begin in the report.
#[derive(Default)]
pub struct Included {
    files: Vec<(usize, Include)>,
    sources: Vec<Arc<Source>>,
}

impl Included {
    /// Whether a place is in one of the files.
    pub fn has(&self, at: &Span) -> bool {
        let source = at.source.as_ref();
        source.is_some_and(|s| self.sources.iter().any(|own| Arc::ptr_eq(own, s)))
    }

    /// Texts of the files, with the positions where they begin in the report.
    pub fn texts(&self) -> impl Iterator<Item = (&str, usize)> {
        self.files
            .iter()
            .map(|(start, file)| (file.text.as_str(), *start))
    }

    /// The files.
    pub fn files(&self) -> impl Iterator<Item = &Include> {
        self.files.iter().map(|(_, file)| file)
    }
}

/// Reads the files that a text includes and those that they include, each once, in the order in
/// which they are named. The text begins at `start` in the report, and `path` is its file; every file
/// that is looked for in the folders is added to `dependencies`.
pub fn collect(
    (text, start): (&str, usize),
    path: &Path,
    folders: &[PathBuf],
    dependencies: &Dependencies,
    report: &mut Report,
) -> Included {
    let mut included = Included::default();
    let mut known: HashSet<PathBuf> = path.canonicalize().into_iter().collect();
    // Used as a stack: the last one is read next.
    let mut waiting = named(text, start, start == 0, report);
    waiting.reverse();
    while let Some(name) = waiting.pop() {
        if included.files.len() == MOST {
            let message = format!("a scene may include at most {MOST} files");
            report.push(Diagnostic::at("too-many-files", name.at, message));
            report.note_lacking_names();
            break;
        }
        match confined_read::read(folders, &name.value, &SCENES, dependencies) {
            Ok(found) if known.insert(found.real.clone()) => {
                let base = report.add_source(&found.path, &found.text);
                waiting.extend(named(&found.text, base, false, report).into_iter().rev());
                let file = Include {
                    name: name.value,
                    path: found.real,
                    text: found.text,
                };
                included.files.push((base, file));
                included.sources.extend(report.span(&(base..base)).source);
            }
            Ok(_) => {}
            Err(problem) => {
                report.push(problem.at_name("include-file", name.at));
                report.note_lacking_names();
            }
        }
    }
    included
}

/// The files that a text includes. Mistakes of the scene's own text are reported when it is read.
fn named(text: &str, base: usize, is_scene: bool, report: &mut Report) -> Vec<At<String>> {
    // This parses the text a second time, so texts without the word are skipped.
    if !text.contains("include") {
        return Vec::new();
    }
    let (root, _) = DeTable::parse_recoverable(text);
    let Some(node) = root.into_inner().remove("include") else {
        return Vec::new();
    };
    let named = Named {
        key: "include",
        range: &ANY,
    };
    let node = shift(node, base);
    if is_scene && Names::read(&node, &named, &mut report.silent()).is_none() {
        return Vec::new();
    }
    Names::read(&node, &named, report).map_or_else(Vec::new, |names| names.0)
}

/// Merges included files into the tree, in the order in which they are named and after the scene's own
/// entries. Parts that syntax errors in them make doubtful are added to `shadows`.
pub fn merge<'i>(
    root: &mut Node<'i>,
    included: &'i Included,
    shadows: &mut Vec<Shadow>,
    report: &mut Report,
) {
    for (base, file) in &included.files {
        let (added, more) = syntax::parse(&file.text, *base, report);
        shadows.extend(more);
        let DeValue::Table(root) = root.get_mut() else {
            return;
        };
        let added = Node::new(added.span(), DeValue::Table(added.into_inner()));
        let DeValue::Table(added) = shift(added, *base).into_inner() else {
            return;
        };
        for (key, node) in added {
            add(root, key, node, report);
        }
    }
}

/// Adds one key of an included file to the scene's.
fn add<'i>(
    root: &mut DeTable<'i>,
    key: Spanned<DeString<'i>>,
    node: Node<'i>,
    report: &mut Report,
) {
    match key.get_ref().as_ref() {
        "version" => {
            let named = Named {
                key: "version",
                range: &ANY,
            };
            Version::read(&node, &named, report);
        }
        "include" => {}
        "script" => {
            let message = "an included file cannot have a script";
            let error = report.error("include-script", &key.span(), message);
            error.help = Some("name it in the scene itself; scripts share code by `import`".into());
        }
        layer @ ("base" | "remove") => {
            let message = format!("an included file cannot have `{layer}`");
            let error = report.error("include-layer", &key.span(), message);
            error.help = Some("write it in the scene itself, or take this file as `base`".into());
        }
        "motion" | "variant" => add_parts(root, "", key, node, 2, report),
        _ => add_parts(root, "", key, node, 1, report),
    }
}

/// Adds a value to the table at `path`; where both have a table, merges the two, down to `depth` levels.
/// A key that both have below that is an error.
fn add_parts<'i>(
    table: &mut DeTable<'i>,
    path: &str,
    key: Spanned<DeString<'i>>,
    node: Node<'i>,
    depth: u32,
    report: &mut Report,
) {
    let name = key.get_ref().as_ref();
    let Some((first, _)) = table.get_key_value(name) else {
        table.insert(key, node);
        return;
    };
    let first = first.span();
    let Some(existing) = table.get_mut(name) else {
        return;
    };
    match (existing.get_mut(), node.into_inner()) {
        (DeValue::Array(list), DeValue::Array(more)) if name == "instance" => {
            for item in more {
                list.push(item);
            }
        }
        (DeValue::Table(table), DeValue::Table(more)) if depth > 0 => {
            let path = format!("{path}{name}.");
            for (key, node) in more {
                add_parts(table, &path, key, node, depth - 1, report);
            }
        }
        (old, new) => {
            let same = old.type_str() == new.type_str();
            let shown = suggest::key(&format!("{path}{name}"));
            let first = report.span(&first);
            let (message, help) = if same {
                let help = "remove one of the two, or give it another name";
                (format!("{shown} is defined twice"), help)
            } else {
                let help = "write both alike: `[name]` is a table, `[[name]]` one of a list";
                (
                    format!("{shown} is a table in one place and a list in another"),
                    help,
                )
            };
            let error = report.error("duplicate-key", &key.span(), message);
            error.help = Some(help.into());
            error.related = Some((first, "it is first defined here".into()));
        }
    }
}
