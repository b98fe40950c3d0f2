//! `include = [...]`: files of scene text that are merged with the scene's own, so that several scenes
//! share materials, models or lights.

use std::{collections::HashSet, mem::discriminant, path::PathBuf, sync::Arc};

use super::{
    MOST_BYTES,
    syntax_errors::{self, Shadow},
};
use crate::table::{report::Report, value::Named, value::Names, value::Value as _, value::Version};
use crate::{
    confined_read::{self, Kind},
    dependencies::Dependencies,
    desc::{At, Include},
    diagnostic::{Diagnostic, Source, Span},
    range::ANY,
    reach::Reach,
    suggest,
    syntax::{Content, Entries, Key, Node, moved},
};
use reflet_base::files::canonicalize;

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

/// Included files.
#[derive(Debug, Default)]
pub struct Included(Vec<Include>);

impl Included {
    /// Whether a place is in one of the files.
    pub fn has(&self, at: &Span) -> bool {
        let source = at.source.as_ref();
        source.is_some_and(|s| self.0.iter().any(|own| Arc::ptr_eq(&own.source, s)))
    }

    /// The files.
    pub fn files(&self) -> impl Iterator<Item = &Include> {
        self.0.iter()
    }
}

/// Reads the files that a text includes, and their own included files, each once, in the order in which they are named.
/// `is_scene` says whether the text is the outermost scene's own; every file that is looked for in the folders is added
/// to `dependencies`.
pub fn collect(
    source: &Arc<Source>,
    is_scene: bool,
    reach: &Reach,
    dependencies: &Dependencies,
    report: &mut Report,
) -> Included {
    let mut included = Included::default();
    let mut known: HashSet<PathBuf> = canonicalize(&source.path).into_iter().collect();
    // Used as a stack: the last one is read next.
    let mut waiting = named(source, is_scene, report);
    waiting.reverse();
    while let Some(name) = waiting.pop() {
        if included.0.len() == MOST {
            let message = format!("a scene may include at most {MOST} files");
            report.push(Diagnostic::new("too-many-files", name.at, message));
            report.note_lacking_names();
            break;
        }
        match confined_read::read(reach, &name.value, &SCENES, dependencies) {
            Ok(found) if known.insert(found.real.clone()) => {
                let source = Arc::new(Source::new(found.path, found.data));
                if !report.admit(&source, &name.at) {
                    break;
                }
                waiting.extend(named(&source, false, report).into_iter().rev());
                included.0.push(Include {
                    name: name.value,
                    path: found.real,
                    source,
                });
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
fn named(source: &Arc<Source>, is_scene: bool, report: &mut Report) -> Vec<At<String>> {
    let Some(node) = source.syntax().root().get("include") else {
        return Vec::new();
    };
    let named = Named {
        key: "include",
        range: &ANY,
    };
    let node = moved(node, report.start_of(source));
    if is_scene && Names::read(&node, &named, &mut report.silent()).is_none() {
        return Vec::new();
    }
    Names::read(&node, &named, report).map_or_else(Vec::new, |names| names.0)
}

/// Merges included files into the tree, in the order in which they are named and after the scene's own
/// entries. Parts that syntax errors in them make doubtful are added to `shadows`.
pub fn merge(root: &mut Node, included: &Included, shadows: &mut Vec<Shadow>, report: &mut Report) {
    let Content::Table(root) = root.get_mut() else {
        return;
    };
    for file in &included.0 {
        let (added, more) = syntax_errors::tree(&file.source, report);
        shadows.extend(more);
        for (key, node) in added {
            add(root, key, node, report);
        }
    }
}

/// Adds one key of an included file to the scene's.
fn add(root: &mut Entries, key: Key, node: Node, report: &mut Report) {
    match key.get_ref().as_str() {
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
fn add_parts(
    table: &mut Entries,
    path: &str,
    key: Key,
    node: Node,
    depth: u32,
    report: &mut Report,
) {
    let name = key.get_ref().as_str();
    let Some((first, _)) = table.get_key_value(name) else {
        table.insert(key, node);
        return;
    };
    let first = first.span();
    let Some(existing) = table.get_mut(name) else {
        return;
    };
    match (existing.get_mut(), node.into_inner()) {
        (Content::Array(list), Content::Array(more)) if name == "instance" => {
            for item in more {
                list.push(item);
            }
        }
        (Content::Table(table), Content::Table(more)) if depth > 0 => {
            let path = format!("{path}{name}.");
            for (key, node) in more {
                add_parts(table, &path, key, node, depth - 1, report);
            }
        }
        (old, new) => {
            let same = discriminant(old) == discriminant(&new);
            let shown = suggest::key(&format!("{path}{name}"));
            let first = report.span(&first);
            let (message, help) = if same {
                let help = "remove one of the two, or give it another name; to change what a file says, name it \
                            by `base` instead of `include`";
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
