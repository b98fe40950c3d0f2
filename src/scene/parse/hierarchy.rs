//! `parent = "NAME"`: the scene hierarchy. It is read from the tree, so that a parent with a mistake is still
//! known by its name.

use std::{
    collections::{HashMap, HashSet},
    ops::Range,
};

use super::entry_kinds::named_elsewhere;
use crate::syntax::{Entries, Node, key_text};
use crate::table::report::Report;
use crate::{
    desc::{Entry, Parents, SceneDesc},
    suggest,
};

/// Largest number of parents that a message about a circle lists.
const MOST_SHOWN: usize = 8;

/// Name of a table's parent, and its place.
fn named(table: &Entries) -> Option<(&str, Range<usize>)> {
    let node = table.get("parent")?;
    Some((node.get_ref().as_str()?, node.span()))
}

fn tables<'n>(
    root: &'n Entries,
    kind: &str,
) -> impl Iterator<Item = (&'n str, Range<usize>, &'n Entries)> {
    let all = root.get(kind).and_then(|node| node.get_ref().as_table());
    let all = all.into_iter().flat_map(|all| all.iter());
    all.filter_map(|(name, node)| {
        let table = node.get_ref().as_table()?;
        Some((name.get_ref().as_str(), name.span(), table))
    })
}

fn instances(root: &Entries) -> impl Iterator<Item = &Entries> {
    let list = root.get("instance");
    let list = list.and_then(|node| node.get_ref().as_array());
    let items = list.into_iter().flat_map(|list| list.iter());
    items.filter_map(|item: &Node| item.get_ref().as_table())
}

fn name_of(instance: &Entries) -> Option<(&str, Range<usize>)> {
    let node = instance.get("name")?;
    Some((node.get_ref().as_str()?, node.span()))
}

/// Checks that parents exist and form no circles, and that no group has the name of an instance.
pub fn check(root: &Entries, report: &mut Report) {
    let mut nodes: HashMap<&str, Option<(&str, Range<usize>)>> = HashMap::new();
    for instance in instances(root) {
        if let Some((name, _)) = name_of(instance) {
            nodes.insert(name, named(instance));
        }
    }
    for (name, at, group) in tables(root, "group") {
        if nodes.insert(name, named(group)).is_some() {
            let message = format!("an instance and a group are named {}", suggest::text(name));
            let error = report.error("duplicate-name", &at, message);
            error.help = Some("rename one: `parent` could mean either".into());
        }
    }
    let hung = instances(root).filter_map(named);
    let others = ["group", "light", "camera", "decal"];
    let others = others.iter().flat_map(|kind| tables(root, kind));
    let hung = hung.chain(others.filter_map(|(_, _, table)| named(table)));
    for (parent, at) in hung {
        if !nodes.contains_key(parent) {
            let mut elsewhere = named_elsewhere(root, parent);
            if elsewhere.ends_with("is a model; ") {
                elsewhere += &placing(root, parent);
            }
            refuse_dangling(parent, &elsewhere, &at, &nodes, report);
        }
    }
    refuse_circles(&nodes, report);
}

/// Advice to name the instance of a model, or to write one.
fn placing(root: &Entries, model: &str) -> String {
    let name = suggest::text(model);
    let mut models = instances(root).filter_map(|table| table.get("model")?.get_ref().as_str());
    match models.any(|placed| placed == model) {
        true => format!("write `name = {name}` in its `[[instance]]`"),
        false => {
            format!("place it: write `[[instance]]` with `name = {name}` and `model = {name}`")
        }
    }
}

fn refuse_dangling<T>(
    parent: &str,
    elsewhere: &str,
    at: &Range<usize>,
    nodes: &HashMap<&str, T>,
    report: &mut Report,
) {
    if report.lacks_names() {
        return;
    }
    let removed = ["group", "instance"].map(|kind| report.removed(&format!("{kind}.{parent}")));
    let removed = removed.into_iter().flatten().next();
    let message = format!("no instance or group is named {}", suggest::text(parent));
    let help = if removed.is_some() {
        "remove `parent`, or name another parent".to_owned()
    } else if elsewhere.contains("is a model; ") {
        elsewhere.to_owned()
    } else if nodes.is_empty() {
        format!("{elsewhere}write `[group.NAME]`, or give an `[[instance]]` a `name`")
    } else if !elsewhere.is_empty() {
        format!("{elsewhere}write `[group.NAME]`, and its name as `parent` of both")
    } else {
        let mut known: Vec<&str> = nodes.keys().copied().collect();
        known.sort_unstable();
        known.truncate(suggest::MOST_NAMES);
        let lead = format!(
            "write `[group.{}]`, or one of the names",
            key_text(&suggest::clip(parent))
        );
        suggest::hint(parent, &known, suggest::text, &lead)
    };
    let error = report.error("dangling-name", at, message);
    error.help = Some(help);
    error.related = removed.map(|at| (at, "a layer removes it here".into()));
}

fn refuse_circles(nodes: &HashMap<&str, Option<(&str, Range<usize>)>>, report: &mut Report) {
    let mut starts: Vec<_> = nodes
        .iter()
        .filter_map(|(name, parent)| Some((parent.as_ref()?.1.start, *name)))
        .collect();
    starts.sort_unstable();
    let mut is_done: HashSet<&str> = HashSet::new();
    for (_, start) in starts {
        let (mut path, mut on_path) = (Vec::new(), HashSet::new());
        let mut next = Some(start);
        while let Some(name) = next.filter(|name| is_done.insert(name)) {
            on_path.insert(name);
            path.push(name);
            next = nodes.get(name).and_then(|p| p.as_ref()).map(|p| p.0);
        }
        let Some(first) = next.filter(|name| on_path.contains(name)) else {
            continue;
        };
        let from = path.iter().position(|name| *name == first).unwrap_or(0);
        let circle = &path[from..];
        let shown: Vec<_> = (circle.iter().take(MOST_SHOWN))
            .map(|name| suggest::text(name))
            .collect();
        let more = if circle.len() > MOST_SHOWN {
            " → …"
        } else {
            ""
        };
        let message = format!(
            "parents form a circle: {}{more} → {}",
            shown.join(" → "),
            suggest::text(first)
        );
        if let Some(Some((_, at))) = nodes.get(first) {
            let error = report.error("circle", at, message);
            error.help = Some("take `parent` out of one of them".into());
        }
    }
}

/// The parents of a scene that was read from this tree without errors.
pub fn parents(scene: &SceneDesc, root: &Entries) -> Parents {
    let names = scene.node_names().enumerate();
    let index: HashMap<&str, usize> = names.filter_map(|(i, name)| Some((name?, i))).collect();
    let parent = |table: &Entries| named(table).and_then(|(name, _)| index.get(name).copied());
    let mut nodes: Vec<_> = instances(root).map(parent).collect();
    nodes.resize(scene.instances.len(), None);
    fn parents_of<T>(
        root: &Entries,
        kind: &str,
        entries: &[Entry<T>],
        parent: impl Fn(&Entries) -> Option<usize>,
    ) -> Vec<Option<usize>> {
        let all = root.get(kind).and_then(|node| node.get_ref().as_table());
        let one = |entry: &Entry<T>| {
            let table = all?.get(entry.name.as_str())?.get_ref().as_table()?;
            parent(table)
        };
        entries.iter().map(one).collect()
    }
    nodes.extend(parents_of(root, "group", &scene.groups, parent));
    let lights = parents_of(root, "light", &scene.lights, parent);
    let cameras = parents_of(root, "camera", &scene.cameras, parent);
    let decals = parents_of(root, "decal", &scene.decals, parent);
    Parents::new(nodes, lights, cameras, decals)
}
