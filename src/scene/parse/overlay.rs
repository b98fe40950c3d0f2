//! Lays tables over tables: a scene over its base, a variant over a scene. The upper value wins, key by
//! key, and every value keeps the place where it is written.

use std::{collections::HashMap, ops::Range};

use super::{
    rules::{Rules, content_below},
    set,
    tables::Below,
};
use crate::suggest;
use crate::syntax::{Content, Entries, Key, Node};
use crate::table::report::Report;

/// Lays a scene over another one: tables key by key, instances by their names, all else replaced.
pub fn overlay(below: &mut Entries, above: Entries) {
    overlay_at(Some(Below::scene()), below, above);
}

/// Lays the content at `place` over another layer's content there.
pub fn overlay_at(place: Option<Below>, below: &mut Entries, above: Entries) {
    let rules = Rules::at_place(place, &[&above, below]);
    // Before any is put: of keys of `above` that exclude each other none gives way, so that the reader refuses them.
    if let Some(rules) = rules {
        let keys = above.keys();
        keys.for_each(|key| rules.make_room(below, key.get_ref()));
    }
    for (key, node) in above {
        put(place, below, key, node);
    }
}

fn put(place: Option<Below>, below: &mut Entries, key: Key, node: Node) {
    let name = key.get_ref().as_str();
    let Some(existing) = below.get_mut(name) else {
        below.insert(key, node);
        return;
    };
    let at = node.span();
    match (existing.get_mut(), node.into_inner()) {
        (Content::Table(old), Content::Table(new)) if same_kind(old, &new) => {
            overlay_at(content_below(place, name), old, new);
        }
        (Content::Array(old), Content::Array(new)) if name == "instance" => {
            overlay_instances(content_below(place, name), old, new.into_iter());
        }
        (_, new) => {
            // Removed first, so that the key has the place of the upper one.
            below.remove(name);
            below.insert(key, Node::new(at, new));
        }
    }
}

/// Whether two tables may have the same `kind`; keys of another kind do not apply.
fn same_kind(old: &Entries, new: &Entries) -> bool {
    let kind = |table: &Entries| {
        let kind = table.get("kind")?.get_ref().as_str()?;
        Some(kind.to_owned())
    };
    match (kind(old), kind(new)) {
        (Some(old), Some(new)) => old == new,
        _ => true,
    }
}

/// Instances of the same name are laid over each other, the others are added.
fn overlay_instances(
    place: Option<Below>,
    below: &mut Vec<Node>,
    above: impl Iterator<Item = Node>,
) {
    let mut named: HashMap<String, usize> = HashMap::new();
    for (index, node) in below.iter().enumerate() {
        if let Some(name) = name_of(node) {
            named.entry(name.to_owned()).or_insert(index);
        }
    }
    for node in above {
        let known = name_of(&node).map(|name| *named.entry(name.to_owned()).or_insert(below.len()));
        let existing = known.and_then(|index| below.get_mut(index));
        match (existing.map(Node::get_mut), node.get_ref()) {
            (Some(Content::Table(old)), Content::Table(_)) => {
                if let Content::Table(new) = node.into_inner() {
                    overlay_at(place, old, new);
                }
            }
            _ => below.push(node),
        }
    }
}

/// `name` of an instance.
pub fn name_of(node: &Node) -> Option<&str> {
    node.get_ref().as_table()?.get("name")?.get_ref().as_str()
}

/// Positions of instances by name, for many paths into one scene.
pub struct Instances {
    named: HashMap<String, usize>,
    /// Whether each instance was removed; removed ones are dropped by [`Instances::drop_removed`].
    is_removed: Vec<bool>,
}

impl Instances {
    /// Instances of a scene's tree.
    pub fn from_tree(root: &Node) -> Self {
        let list = root.get_ref().as_table().and_then(|t| t.get("instance"));
        let list = list.and_then(|node| node.get_ref().as_array());
        let list = list.map_or(&[][..], Vec::as_slice);
        let mut named = HashMap::new();
        for (index, node) in list.iter().enumerate() {
            if let Some(name) = name_of(node) {
                named.entry(name.to_owned()).or_insert(index);
            }
        }
        Self {
            named,
            is_removed: vec![false; list.len()],
        }
    }

    /// Position of the instance with a name, or else with a number among the instances that are left.
    fn find(&self, name: &str) -> Option<usize> {
        let named = self.named.get(name).copied();
        let named = named.filter(|index| !self.is_removed[*index]);
        named.or_else(|| {
            let left = self
                .is_removed
                .iter()
                .enumerate()
                .filter(|(_, gone)| !**gone);
            left.map(|(index, _)| index).nth(name.parse().ok()?)
        })
    }

    /// Notes the instances without a name as removed whose parent is the group `name`: nothing else could name them.
    pub fn remove_unnamed_of(&mut self, name: &str, root: &Node, report: &mut Report) {
        let list = root.get_ref().as_table().and_then(|t| t.get("instance"));
        let list = list.and_then(|node| node.get_ref().as_array());
        let text = |node: &Node, key: &str| {
            let value = node.get_ref().as_table()?.get(key)?;
            value.get_ref().as_str().map(str::to_owned)
        };
        for (node, is_removed) in list.into_iter().flatten().zip(&mut self.is_removed) {
            let is_child = text(node, "parent").is_some_and(|parent| parent == name);
            if is_child && name_of(node).is_none() {
                *is_removed = true;
                if let Some(model) = text(node, "model") {
                    report.note_unplaced(&model);
                }
            }
        }
    }

    /// Drops the removed instances from the tree.
    pub fn drop_removed(self, root: &mut Node) {
        let Content::Table(root) = root.get_mut() else {
            return;
        };
        if let Some(Content::Array(list)) = root.get_mut("instance").map(Node::get_mut) {
            let mut is_removed = self.is_removed.into_iter();
            list.retain(|_| is_removed.next() != Some(true));
        }
    }
}

/// Whether a value exists at a path such as `light.lamp`; `instances` are the tree's.
pub fn has(root: &mut Node, instances: &Instances, path: &str) -> bool {
    let names = set::names_of(path).unwrap_or_default();
    let found = names
        .iter()
        .enumerate()
        .try_fold(root, |node, (depth, name)| {
            let instances = (depth == 1 && names[0] == "instance").then_some(instances);
            child(node, name, instances)
        });
    found.is_some() && !names.is_empty()
}

/// Removes the value at a path such as `light.lamp`; `at` is the place of the path, and `has_script` says
/// whether a script may add to the scene. An instance is only noted in `instances` as removed.
pub fn remove(
    root: &mut Node,
    instances: &mut Instances,
    path: &str,
    has_script: bool,
    at: &Range<usize>,
    report: &mut Report,
) {
    let Some(names) = set::names_of(path).filter(|names| !names.is_empty()) else {
        let message = format!("{} is not a path of names", suggest::text(path));
        let error = report.error("bad-path", at, message);
        error.help = Some("write names with dots between, such as \"light.lamp\"".into());
        return;
    };
    let (above, last) = names.split_at(names.len() - 1);
    let mut node = root;
    for (depth, name) in above.iter().enumerate() {
        let instances = (depth == 1 && names[0] == "instance").then_some(&*instances);
        // Looked for twice, as a reference that is returned early would last until the end.
        if child(node, name, instances).is_none() {
            return nothing(path, name, node, has_script, at, report);
        }
        let Some(next) = child(node, name, instances) else {
            return;
        };
        node = next;
    }
    let last = last[0].as_str();
    let is_list = above.len() == 1 && above[0] == "instance";
    match node.get_mut() {
        Content::Table(table) if table.contains_key(last) => {
            table.remove(last);
            report.note_removed(path, at);
        }
        Content::Array(items) if is_list && instances.find(last).is_some() => {
            if let Some(index) = instances.find(last) {
                let table = items.get(index).and_then(|item| item.get_ref().as_table());
                if let Some(model) = table.and_then(|t| t.get("model")?.get_ref().as_str()) {
                    report.note_unplaced(model);
                }
                instances.is_removed[index] = true;
            }
            report.note_removed(path, at);
        }
        Content::Array(items) if !is_list && index_of(items, last).is_some() => {
            if let Some(index) = index_of(items, last) {
                items.remove(index);
            }
            report.note_removed(path, at);
        }
        _ => nothing(path, last, node, has_script, at, report),
    }
}

/// Reports a path that leads nowhere: `name` is its first part that `node` does not have.
fn nothing(
    path: &str,
    name: &str,
    node: &Node,
    has_script: bool,
    at: &Range<usize>,
    report: &mut Report,
) {
    if report.lacks_names() {
        return;
    }
    let message = format!("there is nothing at {} to remove", suggest::text(path));
    if report.is_full() {
        report.error("dangling-name", at, message);
        return;
    }
    if let Some(first) = report.removed(path) {
        let error = report.error("dangling-name", at, message);
        error.help = Some("take it out of one of the two `remove` lists".into());
        error.related = Some((first, "it is removed here already".into()));
        return;
    }
    let known = names_in(node);
    let elsewhere = whole_path(path, name, node);
    if let Some(meant) = elsewhere {
        let help = format!("write {meant}");
        report.error("dangling-name", at, message).help = Some(help);
        return;
    }
    let written = match suggest::nearest(name, known.iter().copied()) {
        None if has_script => {
            "only what is written in scene text can be removed; what a script makes it can leave out by a \
             parameter, such as `params = { lamps = false }`"
                .to_owned()
        }
        None if known.is_empty() => "only what the base has can be removed".to_owned(),
        _ => suggest::hint(name, &known, suggest::text, "the names are"),
    };
    report.error("dangling-name", at, message).help = Some(written);
}

/// Paths in the scene that may be meant by a path whose first part is no table: `light.key` for `key` or `lights.key`.
fn whole_path(path: &str, first: &str, scene: &Node) -> Option<String> {
    if !path.starts_with(first) {
        return None;
    }
    let last = path.rsplit('.').next()?;
    let tables = scene.get_ref().as_table()?;
    let found = tables
        .iter()
        .filter(|(_, table)| names_in(table).contains(&last));
    let found: Vec<_> = found
        .map(|(table, _)| suggest::text(&format!("{}.{last}", table.get_ref())))
        .collect();
    (!found.is_empty()).then(|| found.join(" or "))
}

fn index_of(items: &[Node], name: &str) -> Option<usize> {
    let named = items.iter().position(|item| name_of(item) == Some(name));
    let index = || name.parse().ok().filter(|index| *index < items.len());
    named.or_else(index)
}

/// Names of the children of a node.
fn names_in(node: &Node) -> Vec<&str> {
    match node.get_ref() {
        Content::Table(table) => table.keys().map(|k| k.get_ref().as_str()).collect(),
        Content::Array(items) => items.iter().filter_map(name_of).collect(),
        _ => Vec::new(),
    }
}

/// The child of that name; `instances` are the scene's where the node is their list.
fn child<'n>(
    node: &'n mut Node,
    name: &str,
    instances: Option<&Instances>,
) -> Option<&'n mut Node> {
    match node.get_mut() {
        Content::Table(table) => table.get_mut(name),
        Content::Array(items) => {
            let index = match instances {
                Some(instances) => instances.find(name),
                None => index_of(items, name),
            };
            items.get_mut(index?)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests;
