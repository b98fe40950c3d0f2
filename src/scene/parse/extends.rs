//! `extends = "paint"`: a material that inherits those keys of another that it does not have itself.

use std::collections::{HashMap, HashSet};

use super::{
    rules::{Rules, content_below},
    tables::Below,
};
use crate::suggest;
use crate::syntax::{Content, Entries, Node, Size};
use crate::table::report::Report;

/// Largest number of materials that extend each other in a chain.
const MOST: usize = 100;

/// Name of the material that a material's table extends.
pub fn extended(table: &Entries) -> Option<&str> {
    table.get("extends")?.get_ref().as_str()
}

/// Gives every material the keys of the materials that it extends; also materials of instances and overrides of a
/// file's.
pub fn resolve(root: &mut Node, report: &mut Report) {
    let Content::Table(root) = root.get_mut() else {
        return;
    };
    if !tables(root).any(|table| extended(table).is_some()) {
        return;
    }
    let own = root
        .get("material")
        .and_then(|node| node.get_ref().as_table());
    let Some(materials) = own.cloned() else {
        for table in tables(root) {
            report_missing(table, &Entries::new(), report);
        }
        return;
    };
    for table in tables(root) {
        report_missing(table, &materials, report);
    }
    report_circles(&materials, report);
    let (mut flat, mut size) = (HashMap::new(), Size::default());
    let mut too_large = None;
    each_table_mut(root, &mut |table| {
        if too_large.is_some() {
            return;
        }
        let at = table.get("extends").map(Node::span);
        let mut chain = Vec::new();
        let mut next = extended(table).map(str::to_owned);
        while let Some(name) = next.take().filter(|name| !chain.contains(name)) {
            let parent = materials.get(name.as_str());
            let Some(parent) = parent.and_then(|node| node.get_ref().as_table()) else {
                break;
            };
            next = extended(parent).map(str::to_owned);
            chain.push(name);
            if chain.len() > MOST {
                break; // reported
            }
        }
        for name in chain {
            let keys = flat.entry(name).or_insert_with_key(|name: &String| {
                let parent = materials.get(name.as_str());
                let parent = parent.and_then(|node| node.get_ref().as_table());
                parent.cloned().unwrap_or_default()
            });
            add_missing(table, keys, &mut size);
        }
        too_large = at.zip(size.excess());
    });
    if let Some((at, excess)) = too_large {
        let message = format!("materials inherit more than {excess} by `extends`");
        let error = report.error("scene-too-large", &at, message);
        error.help = Some("extend fewer materials, or smaller ones".into());
    }
}

/// Adds the keys that the table does not have, also to `size`.
fn add_missing(table: &mut Entries, parent: &Entries, size: &mut Size) {
    let materials = content_below(Some(Below::scene()), "material");
    let rules = Rules::at_place(content_below(materials, ""), &[]);
    for (key, node) in parent {
        let name = key.get_ref().as_str();
        let mut excluded = rules.into_iter().flat_map(|rules| rules.excluded_by(name));
        let has = table.contains_key(name) || excluded.any(|own| table.contains_key(own));
        if !has && name != "extends" {
            size.add(node);
            table.insert(key.clone(), node.clone());
        }
    }
}

fn report_missing(table: &Entries, materials: &Entries, report: &mut Report) {
    let (Some(name), Some(node)) = (extended(table), table.get("extends")) else {
        return;
    };
    if materials.contains_key(name) || report.lacks_names() {
        return;
    }
    let names = materials.keys().map(|k| k.get_ref().as_str());
    let names: Vec<_> = names.take(suggest::MOST_NAMES).collect();
    let message = format!("no material is named {}", suggest::text(name));
    if report.is_full() {
        report.error("dangling-name", &node.span(), message);
        return;
    }
    report.error("dangling-name", &node.span(), message).help = Some(match names.is_empty() {
        true => "write a table `[material.NAME]` and refer to its name".to_owned(),
        false => suggest::hint(name, &names, suggest::text, "the materials are"),
    });
}

/// Reports materials that extend themselves, and chains that are too long.
fn report_circles(materials: &Entries, report: &mut Report) {
    let table = |name: &str| {
        materials
            .get(name)
            .and_then(|node| node.get_ref().as_table())
    };
    for (key, node) in materials {
        let name = key.get_ref().as_str();
        let Some(own) = node.get_ref().as_table() else {
            continue;
        };
        let mut next = extended(own);
        let mut passed = HashSet::new();
        for step in 0.. {
            let Some(parent) = next else { break };
            let at = own.get("extends").map_or(key.span(), |node| node.span());
            if parent == name {
                let message = format!("{} extends itself", suggest::text(name));
                let error = report.error("circle", &at, message);
                error.help = Some("take `extends` out of one material of the circle".into());
                break;
            }
            if step == MOST {
                let message = format!("more than {MOST} materials extend each other in a chain");
                report.error("too-deep", &at, message).help =
                    Some("extend a material that is nearer to the end of the chain".into());
                break;
            }
            if !passed.insert(parent) {
                break; // a circle of other materials, reported at these
            }
            next = table(parent).and_then(extended);
        }
    }
}

/// All tables of materials: of the scene, of models and of instances.
pub fn tables<'n>(root: &'n Entries) -> impl Iterator<Item = &'n Entries> {
    let table = |node: &'n Node| node.get_ref().as_table();
    let named = move |root: &'n Entries, key: &str| root.get(key).and_then(table);
    let own = named(root, "material").into_iter().flat_map(|t| t.values());
    let models = named(root, "model").into_iter().flat_map(|t| t.values());
    let models = models.filter_map(table);
    let overrides = models.filter_map(move |model| named(model, "material"));
    let overrides = overrides.flat_map(|t| t.values());
    let list = root
        .get("instance")
        .and_then(|node| node.get_ref().as_array());
    let instances = list.into_iter().flatten().filter_map(table);
    let instances = instances.filter_map(|instance| instance.get("material"));
    own.chain(overrides).chain(instances).filter_map(table)
}

/// Calls `change` for each of the tables that [`tables`] lists.
fn each_table_mut(root: &mut Entries, change: &mut impl FnMut(&mut Entries)) {
    fn each(node: Option<&mut Node>, change: &mut impl FnMut(&mut Entries)) {
        let Some(Content::Table(entries)) = node.map(Node::get_mut) else {
            return;
        };
        for (_, entry) in entries.iter_mut() {
            if let Content::Table(table) = entry.get_mut() {
                change(table);
            }
        }
    }
    each(root.get_mut("material"), change);
    if let Some(Content::Table(models)) = root.get_mut("model").map(Node::get_mut) {
        for (_, model) in models.iter_mut() {
            if let Content::Table(model) = model.get_mut() {
                each(model.get_mut("material"), change);
            }
        }
    }
    if let Some(Content::Array(list)) = root.get_mut("instance").map(Node::get_mut) {
        for instance in list.iter_mut() {
            if let Content::Table(instance) = instance.get_mut()
                && let Some(Content::Table(table)) = instance.get_mut("material").map(Node::get_mut)
            {
                change(table);
            }
        }
    }
}
