//! The scene's script, run while the text is read: what `setup` returns is scene text that is laid
//! beside the scene's own, so that the same readers check both.

use std::path::Path;

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{
    params,
    report::Report,
    set::shift,
    table::{Place, Table},
    value::Node,
};
use crate::scene::suggest;
use crate::scene::{
    dependencies::Dependencies,
    desc::{At, TimelineDesc},
    script::Script,
};

/// The script of a scene and what it adds.
#[derive(Default)]
pub struct Scripted {
    /// The script, if it can be run.
    pub script: Option<Script>,
    /// What `setup` returned, as scene text.
    pub additions: String,
    /// Where that text begins in the report.
    base: usize,
}

/// Loads the script that the tree names and calls its `setup`; the files that it looks for are added
/// to `dependencies`.
pub fn run(
    root: &DeTable,
    folder: &Path,
    dependencies: &Dependencies,
    report: &mut Report,
) -> Scripted {
    let Some(node) = root.get("script") else {
        return Scripted::default();
    };
    let scripted = run_named(node, root, folder, dependencies, report);
    if scripted.is_none() {
        report.note_lacking_names();
    }
    scripted.unwrap_or_default()
}

/// `None` after a mistake, which is reported here or when the whole scene is read.
fn run_named(
    node: &Node,
    root: &DeTable,
    folder: &Path,
    dependencies: &Dependencies,
    report: &mut Report,
) -> Option<Scripted> {
    let file = node.get_ref().as_str()?;
    let file = At {
        value: file.to_owned(),
        at: report.span(&node.span()),
    };
    let script = match Script::load(folder, &file, dependencies) {
        Ok(script) => script,
        Err(error) => {
            report.push(*error);
            return None;
        }
    };
    // Mistakes of these tables are reported when the whole scene is read.
    let mut unheard = report.unheard();
    let table = |key| root.get(key).and_then(|node| node.get_ref().as_table());
    let timeline: Option<TimelineDesc> =
        table("timeline").and_then(|t| Table::read(&mut unheard, t, Place::default()));
    let values = table("params").map_or_else(Vec::new, |t| params::read(t, &mut unheard));
    if unheard.errors() > 0 {
        return None;
    }
    match script.setup(&values, timeline.as_ref()) {
        Ok(additions) => {
            let base = report.add_returned(&script, &additions);
            Some(Scripted {
                script: Some(script),
                additions,
                base,
            })
        }
        Err(error) => {
            report.push(*error);
            None
        }
    }
}

/// Lays the additions into the tree.
pub fn merge<'i>(root: &mut Node<'i>, scripted: &'i Scripted, report: &mut Report) {
    let Ok(added) = DeTable::parse(&scripted.additions) else {
        return; // it was written by this program
    };
    let at = added.span();
    let added = Node::new(at, DeValue::Table(added.into_inner()));
    let (DeValue::Table(added), DeValue::Table(root)) =
        (shift(added, scripted.base).into_inner(), root.get_mut())
    else {
        return;
    };
    for (key, node) in added {
        let Some(existing) = root.get_mut(key.get_ref().as_ref()) else {
            root.insert(key, node);
            continue;
        };
        match (existing.get_mut(), node.into_inner()) {
            (DeValue::Array(list), DeValue::Array(more)) => {
                for item in more {
                    list.push(item);
                }
            }
            (DeValue::Table(table), DeValue::Table(more)) => {
                for (name, node) in more {
                    add_named(table, key.get_ref(), name, node, report);
                }
            }
            // The scene's own value has the wrong type, which its reader says.
            _ => {}
        }
    }
}

fn add_named<'i>(
    table: &mut DeTable<'i>,
    kind: &str,
    name: Spanned<toml::de::DeString<'i>>,
    node: Node<'i>,
    report: &mut Report,
) {
    if let Some((first, _)) = table.get_key_value(name.get_ref().as_ref()) {
        let message = format!("two {kind}s are named {}", suggest::text(name.get_ref()));
        let first = report.span(&first.span());
        let error = report.error("duplicate-name", &name.span(), message);
        error.help = Some("setup can add to the scene, but not replace what it has".into());
        error.related = Some((first, "the scene's own is here".into()));
        return;
    }
    table.insert(name, node);
}
