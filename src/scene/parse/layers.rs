//! `base = "….toml"`, `remove` and `[variant.NAME]`: a scene as changes to another one.

use std::{collections::HashSet, ops::Range, path::PathBuf, sync::Arc};

use super::{
    include::{self, Included},
    near_names,
    overlay::{self, Instances},
    set,
    syntax_errors::{self, Shadow},
};
use crate::table::{report::Report, value::Named, value::Names, value::Value as _};
use crate::{
    confined_read::{self, Kind},
    dependencies::Dependencies,
    desc::{At, Include},
    diagnostic::{Diagnostic, Source, Span},
    range::ANY,
    reach::Reach,
    suggest,
    syntax::{Content, Node, moved},
};
use reflet_base::files::canonicalize;

/// Largest number of bases in a chain.
const MOST: usize = 100;

/// Words for bases in messages about their files.
const BASES: Kind = Kind {
    one: "scene text",
    names: "names of bases start from the scene's folder or an asset folder (--assets DIR)",
    inside: "bases are read only from the scene's folder, asset folders, and the folders below",
    most_mib: super::MOST_BYTES >> 20,
};

/// A base, with the files that it includes.
#[derive(Debug)]
pub struct Base {
    file: Include,
    included: Included,
}

impl Base {
    /// The base's file and the files that it includes.
    pub fn files(&self) -> impl Iterator<Item = &Include> {
        std::iter::once(&self.file).chain(self.included.files())
    }

    /// Whether a place is in a file that the base includes.
    pub fn includes(&self, at: &Span) -> bool {
        self.included.has(at)
    }
}

/// Reads the base of a text, the base of that base, and so on. `is_scene` says whether the text is the
/// outermost scene's own; bases are looked for in the folders of `reach`, the scene's own first.
pub fn collect(
    source: &Arc<Source>,
    is_scene: bool,
    reach: &Reach,
    dependencies: &Dependencies,
    report: &mut Report,
) -> Vec<Base> {
    let mut bases: Vec<Base> = Vec::new();
    let mut known: HashSet<PathBuf> = canonicalize(&source.path).into_iter().collect();
    let mut next = named(source, is_scene, report);
    while let Some(name) = next.take() {
        if bases.len() == MOST {
            let message = format!("a chain of bases may have at most {MOST} files");
            report.push(Diagnostic::new("too-many-files", name.at, message));
            report.note_lacking_names();
            break;
        }
        let found = match confined_read::read(reach, &name.value, &BASES, dependencies) {
            Ok(found) => found,
            Err(problem) => {
                report.push(problem.at_name("base-file", name.at));
                report.note_lacking_names();
                break;
            }
        };
        if !known.insert(found.real.clone()) {
            let shown = suggest::text(&name.value);
            let message = format!("{shown} is its own base, directly or through others");
            let error = Diagnostic::new("circle", name.at, message);
            report.push(error.help("take `base` out of one file of the circle"));
            report.note_lacking_names();
            break;
        }
        let source = Arc::new(Source::new(found.path, found.data));
        if !report.admit(&source, &name.at) {
            break;
        }
        next = named(&source, false, report);
        let included = include::collect(&source, false, reach, dependencies, report);
        bases.push(Base {
            file: Include {
                name: name.value,
                path: found.real,
                source,
            },
            included,
        });
    }
    bases
}

/// The base that a text names. A mistake of the scene's own text is reported when it is read.
fn named(source: &Arc<Source>, is_scene: bool, report: &mut Report) -> Option<At<String>> {
    let node = source.syntax().root().get("base")?;
    let node = moved(node, report.start_of(source));
    let named = Named {
        key: "base",
        range: &ANY,
    };
    if is_scene {
        At::read(&node, &named, &mut report.silent())?;
    }
    At::read(&node, &named, report)
}

/// Merges the trees of a scene and its bases: each base is laid over its own base, starting with the
/// lowest, and the scene's own tree over all.
pub fn merge(own: Node, bases: &[Base], shadows: &mut Vec<Shadow>, report: &mut Report) -> Node {
    let mut below: Option<Node> = None;
    for base in bases.iter().rev() {
        let (tree, more) = syntax_errors::tree(&base.file.source, report);
        shadows.extend(more);
        let start = report.start_of(&base.file.source);
        let mut tree = Node::new(start..start, Content::Table(tree));
        include::merge(&mut tree, &base.included, shadows, report);
        below = Some(match below {
            Some(below) => over(below, tree, report),
            None => {
                if let Content::Table(table) = tree.get_mut() {
                    table
                        .remove("remove")
                        .iter()
                        .for_each(|n| refuse_remove(n, report));
                    table.remove("base");
                    table.remove("include");
                }
                tree
            }
        });
    }
    match below {
        Some(below) => {
            let keep = own.clone();
            let mut root = over(below, own, report);
            // The reader gets these keys as the scene itself has them.
            if let (Content::Table(root), Content::Table(own)) = (root.get_mut(), keep.into_inner())
            {
                let layers = ["base", "include", "remove"];
                let own = own
                    .into_iter()
                    .filter(|(k, _)| layers.contains(&k.get_ref().as_str()));
                root.extend(own);
            }
            root
        }
        None => {
            let removed = own.get_ref().as_table().and_then(|t| t.get("remove"));
            // A base that cannot be read was reported.
            let has_base = own
                .get_ref()
                .as_table()
                .is_some_and(|t| t.contains_key("base"));
            if !has_base {
                removed.iter().for_each(|node| refuse_remove(node, report));
            }
            own
        }
    }
}

fn refuse_remove(node: &Node, report: &mut Report) {
    let message = "there is no base of which something could be removed";
    let error = report.error("dangling-name", &node.span(), message);
    error.help = Some("name one by `base = \"….toml\"`, or write `remove` in a variant".into());
}

/// Lays one tree over another, from which the entries in its `remove` are taken out first.
fn over(mut below: Node, above: Node, report: &mut Report) -> Node {
    let at = above.span();
    let Content::Table(mut above) = above.into_inner() else {
        return below;
    };
    ["base", "include"]
        .iter()
        .for_each(|key| drop(above.remove(*key)));
    if let Some(removed) = above.remove("remove") {
        let table = below.get_ref().as_table();
        let has_script = table
            .into_iter()
            .chain([&above])
            .any(|t| t.contains_key("script"));
        remove_all(&mut below, &removed, has_script, report);
    }
    near_names::warn(&below, &above, report);
    match below.into_inner() {
        Content::Table(mut below) => {
            overlay::overlay(&mut below, above);
            Node::new(at, Content::Table(below))
        }
        other => Node::new(at, other),
    }
}

fn remove_all(below: &mut Node, removed: &Node, has_script: bool, report: &mut Report) {
    let each: Vec<(&str, Range<usize>)> = match removed.get_ref() {
        Content::Array(items) => {
            let texts = items
                .iter()
                .filter_map(|i| Some((i.get_ref().as_str()?, i.span())));
            texts.collect()
        }
        Content::String(text) => vec![(text.as_ref(), removed.span())],
        _ => Vec::new(),
    };
    let named = Named {
        key: "remove",
        range: &ANY,
    };
    if Names::read(removed, &named, report).is_some() {
        let mut instances = Instances::from_tree(below);
        for (path, at) in each {
            let names = set::names_of(path).unwrap_or_default();
            let group = match names.as_slice() {
                [kind, name] if kind == "group" && overlay::has(below, &instances, path) => {
                    Some(name)
                }
                _ => None,
            };
            overlay::remove(below, &mut instances, path, has_script, &at, report);
            if let Some(name) = group {
                instances.remove_unnamed_of(name, below, report);
            }
        }
        instances.drop_removed(below);
    }
}

/// Refuses keys of files in a variant, which would have no effect.
fn refuse_layers(variant: &Node, report: &mut Report) {
    let keys = variant.get_ref().as_table();
    for key in keys.into_iter().flat_map(|table| table.keys()) {
        let name = key.get_ref().as_str();
        if ["base", "include", "variant"].contains(&name) {
            let message = format!("a variant cannot have `{name}`");
            let error = report.error("variant-layer", &key.span(), message);
            error.help =
                Some("write it in the scene itself, over which the variant is laid".into());
        }
    }
}

/// Lays the chosen `[variant.NAME]` over the scene, in the order in which they are chosen; each is given by
/// its name.
pub fn choose(mut root: Node, chosen: &[Arc<Source>], report: &mut Report) -> Node {
    for source in chosen {
        let name = source.text.as_str();
        let variants = root.get_ref().as_table().and_then(|t| t.get("variant"));
        let variants = variants.and_then(|node| node.get_ref().as_table());
        match variants.and_then(|all| all.get(name)).cloned() {
            Some(variant) => {
                report.begin_variant(name);
                refuse_layers(&variant, report);
                root = over(root, variant, report);
                let instances = Instances::from_tree(&root);
                report.end_variant(|path| overlay::has(&mut root, &instances, path));
            }
            None if report.lacks_names() => {}
            None => {
                let names = variants.into_iter().flat_map(|all| all.keys());
                let names: Vec<_> = names.map(|k| k.get_ref().as_str()).collect();
                let help = match names.is_empty() {
                    true => "the scene has no `[variant.NAME]`".to_owned(),
                    false => suggest::hint(name, &names, suggest::text, "the variants are"),
                };
                let message = format!("no variant is named {}", suggest::text(name));
                let start = report.start_of(source);
                let at = start..start + name.len();
                report.error("dangling-name", &at, message).help = Some(help);
            }
        }
    }
    root
}
