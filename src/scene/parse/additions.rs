//! Merges the scene text that a script's `setup` returned into the tree of the scene, so that the same
//! readers check both.

use std::sync::Arc;

use crate::table::report::Report;
use crate::{
    diagnostic::Source,
    suggest,
    syntax::{Content, Entries, Key, Node},
};

/// Merges the scene text of a script into the tree. The text is without errors, since this program wrote it.
pub fn merge(root: &mut Node, text: &Arc<Source>, report: &mut Report) {
    let Content::Table(root) = root.get_mut() else {
        return;
    };
    let start = report.add(text);
    for (key, node) in text.syntax().moved(start) {
        let Some(existing) = root.get_mut(key.get_ref().as_str()) else {
            root.insert(key, node);
            continue;
        };
        match (existing.get_mut(), node.into_inner()) {
            (Content::Array(list), Content::Array(more)) => {
                for item in more {
                    list.push(item);
                }
            }
            (Content::Table(_), Content::Table(_)) if key.get_ref() == "environment" => {
                let message = "the scene has an `[environment]` of its own";
                let error = report.error("duplicate-name", &key.span(), message);
                error.help = Some("setup can add to the scene, but not replace what it has".into());
            }
            (Content::Table(table), Content::Table(more)) => {
                for (name, node) in more {
                    add_named(table, key.get_ref(), name, node, report);
                }
            }
            // The scene's own value has the wrong type, which its reader reports.
            _ => {}
        }
    }
}

fn add_named(table: &mut Entries, kind: &str, name: Key, node: Node, report: &mut Report) {
    if let Some((first, _)) = table.get_key_value(name.get_ref().as_str()) {
        let message = format!("two {kind}s are named {}", suggest::text(name.get_ref()));
        let first = report.span(&first.span());
        let error = report.error("duplicate-name", &name.span(), message);
        error.help = Some("setup can add to the scene, but not replace what it has".into());
        error.related = Some((first, "the scene's definition is here".into()));
        return;
    }
    table.insert(name, node);
}
