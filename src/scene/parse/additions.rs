//! Merges the scene text that a script's `setup` returned into the tree of the scene, so that the same
//! readers check both.

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

use super::{report::Report, set::shift, value::Node};
use crate::scene::suggest;

/// Merges scene text into the tree; `base` is its position in the report.
pub fn merge<'i>(root: &mut Node<'i>, text: &'i str, base: usize, report: &mut Report) {
    let Ok(added) = DeTable::parse(text) else {
        return; // cannot happen: this program wrote the text
    };
    let at = added.span();
    let added = Node::new(at, DeValue::Table(added.into_inner()));
    let (DeValue::Table(added), DeValue::Table(root)) =
        (shift(added, base).into_inner(), root.get_mut())
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
            (DeValue::Table(_), DeValue::Table(_)) if key.get_ref() == "environment" => {
                let message = "the scene has an `[environment]` of its own";
                let error = report.error("duplicate-name", &key.span(), message);
                error.help = Some("setup can add to the scene, but not replace what it has".into());
            }
            (DeValue::Table(table), DeValue::Table(more)) => {
                for (name, node) in more {
                    add_named(table, key.get_ref(), name, node, report);
                }
            }
            // The scene's own value has the wrong type, which its reader reports.
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
        error.related = Some((first, "the scene's definition is here".into()));
        return;
    }
    table.insert(name, node);
}
