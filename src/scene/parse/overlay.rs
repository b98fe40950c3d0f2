//! Lays tables over tables: a scene over its base, a variant over a scene. The upper value wins, key by
//! key, and every value keeps the place where it is written.

use super::{report::Report, set};
use crate::suggest;
use crate::syntax::{Content, Entries, Key, Node};

/// Groups of keys that exclude each other: a key of one group in the upper table removes the keys of the
/// other groups from the lower table.
const EXCLUSIVE: [&[&[&str]]; 7] = [
    &[&["repeat"], &["instances_from"]],
    &[&["file"], &["shape"]],
    &[&["checker"], &["pattern"], &["base_color_texture"]],
    &[&["direction"], &["target"]],
    &[
        &["matrix"],
        &["translation", "rotation_deg", "rotation_quat", "scale"],
    ],
    &[&["rotation_deg"], &["rotation_quat"]],
    &[&["color"], &["zenith", "horizon", "ground"]],
];

/// Level of a table: the meaning of its keys.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Level {
    /// Keys of a scene, or of `motion`.
    Scene,
    /// Names of variants.
    Variants,
    /// Other names that users choose, such as those of cameras.
    Names,
    /// Keys of one entry, such as a camera or an instance.
    Keys,
}

impl Level {
    /// Level of the table under a key.
    fn below(self, key: &str) -> Self {
        match (self, key) {
            (
                Self::Scene,
                "camera" | "group" | "instance" | "light" | "material" | "model" | "params",
            ) => Self::Names,
            (Self::Scene, "motion") | (Self::Variants, _) => Self::Scene,
            (Self::Scene, "variant") => Self::Variants,
            _ => Self::Keys,
        }
    }
}

/// Lays a scene over another one: tables key by key, instances by their names, all else replaced.
pub fn overlay(below: &mut Entries, above: Entries) {
    overlay_at(Level::Scene, below, above);
}

/// Lays the keys of one entry over those of another.
pub fn overlay_keys(below: &mut Entries, above: Entries) {
    overlay_at(Level::Keys, below, above);
}

fn overlay_at(level: Level, below: &mut Entries, above: Entries) {
    for (key, node) in above {
        // A model may be called "file", and another one "shape".
        if level == Level::Keys {
            drop_excluded(below, key.get_ref());
        }
        put(level, below, key, node);
    }
}

/// Whether two keys cannot be in the same table.
pub fn exclude_each_other(a: &str, b: &str) -> bool {
    EXCLUSIVE.iter().any(|groups| {
        let of = |key: &str| groups.iter().position(|group| group.contains(&key));
        matches!((of(a), of(b)), (Some(a), Some(b)) if a != b)
    })
}

fn drop_excluded(below: &mut Entries, key: &str) {
    let excluded: Vec<String> = (below.keys().map(|k| k.get_ref()))
        .filter(|other| exclude_each_other(key, other))
        .map(ToString::to_string)
        .collect();
    for other in excluded {
        below.remove(other.as_str());
    }
}

fn put(level: Level, below: &mut Entries, key: Key, node: Node) {
    let name = key.get_ref().as_str();
    let Some(existing) = below.get_mut(name) else {
        below.insert(key, node);
        return;
    };
    let at = node.span();
    match (existing.get_mut(), node.into_inner()) {
        (Content::Table(old), Content::Table(new)) if same_kind(old, &new) => {
            overlay_at(level.below(name), old, new);
        }
        (Content::Array(old), Content::Array(new)) if name == "instance" => {
            overlay_instances(old, new.into_iter());
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
fn overlay_instances(below: &mut Vec<Node>, above: impl Iterator<Item = Node>) {
    for node in above {
        let name = name_of(&node).map(str::to_owned);
        let same = |other: &&mut Node| name.is_some() && name_of(other) == name.as_deref();
        let existing = below.iter_mut().find(same);
        match (existing.map(Node::get_mut), node.get_ref()) {
            (Some(Content::Table(old)), Content::Table(_)) => {
                if let Content::Table(new) = node.into_inner() {
                    overlay_at(Level::Keys, old, new);
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

/// Whether a value exists at a path such as `light.lamp`.
pub fn has(root: &mut Node, path: &str) -> bool {
    let names = set::names_of(path).unwrap_or_default();
    let found = names.iter().try_fold(root, |node, name| child(node, name));
    found.is_ok() && !names.is_empty()
}

/// Removes the value at a path such as `light.lamp`; `at` is the place of the path, and `has_script` says
/// whether a script may add to the scene.
pub fn remove(
    root: &mut Node,
    path: &str,
    has_script: bool,
    at: &std::ops::Range<usize>,
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
    for name in above {
        match child(node, name) {
            Ok(next) => node = next,
            Err(known) => return nothing(path, (name, &known), has_script, at, report),
        }
    }
    let last = last[0].as_str();
    let known = match node.get_mut() {
        Content::Table(table) if table.contains_key(last) => {
            table.remove(last);
            report.note_removed(path, at);
            return;
        }
        Content::Table(table) => table.keys().map(|k| k.get_ref().to_string()).collect(),
        Content::Array(items) => match index_of(items, last) {
            Some(index) => {
                let table = items.get(index).and_then(|item| item.get_ref().as_table());
                if let Some(model) = table.and_then(|t| t.get("model")?.get_ref().as_str()) {
                    report.note_unplaced(model);
                }
                let kept = items.iter().enumerate().filter(|(i, _)| *i != index);
                *items = kept.map(|(_, item)| item.clone()).collect();
                report.note_removed(path, at);
                return;
            }
            None => names_in(items),
        },
        _ => Vec::new(),
    };
    nothing(path, (last, &known), has_script, at, report);
}

fn nothing(
    path: &str,
    (name, known): (&str, &[String]),
    has_script: bool,
    at: &std::ops::Range<usize>,
    report: &mut Report,
) {
    if report.lacks_names() {
        return;
    }
    let message = format!("there is nothing at {} to remove", suggest::text(path));
    if let Some(first) = report.removed(path) {
        let error = report.error("dangling-name", at, message);
        error.help = Some("take it out of one of the two `remove` lists".into());
        error.related = Some((first, "it is removed here already".into()));
        return;
    }
    let known: Vec<_> = known.iter().map(String::as_str).collect();
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

fn index_of(items: &[Node], name: &str) -> Option<usize> {
    let named = items.iter().position(|item| name_of(item) == Some(name));
    let index = || name.parse().ok().filter(|index| *index < items.len());
    named.or_else(index)
}

fn names_in(items: &[Node]) -> Vec<String> {
    let names = items.iter().filter_map(name_of);
    names.map(str::to_owned).collect()
}

/// The child of that name; as an error, the names of all children.
fn child<'n>(node: &'n mut Node, name: &str) -> Result<&'n mut Node, Vec<String>> {
    match node.get_mut() {
        Content::Table(table) => {
            if !table.contains_key(name) {
                return Err(table.keys().map(|k| k.get_ref().to_string()).collect());
            }
            table.get_mut(name).ok_or_else(Vec::new)
        }
        Content::Array(items) => match index_of(items, name) {
            Some(index) => items.get_mut(index).ok_or_else(Vec::new),
            None => Err(names_in(items)),
        },
        _ => Err(Vec::new()),
    }
}
