//! `model = { scene = "car.toml" }`: scenes that are placed in a scene. Each becomes a group with the name
//! of its instance. Its entries get that group as parent, and its name and a dot before their own names.

mod collect;
mod group;
mod prefix;
mod run;
mod scripts;

use std::{
    collections::{HashMap, HashSet},
    ops::Range,
    path::Path,
};

pub use self::collect::{Placed, collect};
pub use self::group::{PlacedGroup, name_as_written};
pub use self::run::{RanScript, Run, ScriptInput};
use self::{
    collect::PlacedFile,
    prefix::{Prefix, text},
    run::Runs,
};
use super::{
    include, layers, overlay,
    rules::content_below,
    syntax_errors::{self, Shadow},
    tables::Below,
};
use crate::table::report::Report;
use crate::{
    desc::TimelineDesc,
    suggest,
    syntax::{Content, Entries, Node, Size},
};

/// Largest number of scenes that are placed in a scene, nested ones too.
const MOST_PLACED: usize = 1000;

/// Keys of the placing instance that instances of the placed scene inherit where they lack them.
const INHERITED: [&str; 3] = ["visible", "casts_shadow", "in_reflections"];

/// Keys of an instance that a placed scene cannot have.
const OF_MODELS: [&str; 8] = [
    "along",
    "animation",
    "instances_from",
    "joints",
    "material",
    "morphs",
    "over",
    "repeat",
];

/// The name of the scene that an instance places, with its node.
fn placed_by(instance: &Node) -> Option<(&str, &Node)> {
    let model = instance.get_ref().as_table()?.get("model")?;
    let node = model.get_ref().as_table()?.get("scene")?;
    Some((node.get_ref().as_str()?, node))
}

/// Replaces instances that place scenes by the entries of these scenes; returns the groups that stand for
/// the scenes, inner ones first. `run` runs their scripts, which get `timeline`.
pub fn expand(
    root: &mut Node,
    placed: &Placed,
    run: Run,
    timeline: Option<&TimelineDesc>,
    shadows: &mut Vec<Shadow>,
    report: &mut Report,
) -> Vec<PlacedGroup> {
    let mut expansion = Expansion {
        placed,
        run,
        runs: Runs::default(),
        timeline,
        shadows,
        report,
        groups: Vec::new(),
        above: Vec::new(),
        left: MOST_PLACED,
        size: Size::default(),
        script_limit_met: false,
    };
    if let Content::Table(root) = root.get_mut() {
        expansion.expand(root, "");
    }
    expansion.groups
}

struct Expansion<'p> {
    placed: &'p Placed,
    run: Run<'p>,
    runs: Runs,
    timeline: Option<&'p TimelineDesc>,
    shadows: &'p mut Vec<Shadow>,
    report: &'p mut Report,
    groups: Vec<PlacedGroup>,
    /// Files of the scenes around the placed scene.
    above: Vec<&'p Path>,
    left: usize,
    /// Size of all placed trees, each with the copies of its parts and names that placing it makes.
    size: Size,
    /// Whether a script has exceeded a limit; the others are not run then, as they would take as long.
    script_limit_met: bool,
}

impl<'p> Expansion<'p> {
    /// Expands the scenes that a tree places; names of files in it start from `folder`.
    fn expand(&mut self, root: &mut Entries, folder: &str) {
        let Some(Content::Array(list)) = root.get_mut("instance").map(Node::get_mut) else {
            return;
        };
        if !list.iter().any(|instance| placed_by(instance).is_some()) {
            return;
        }
        let (scenes, others): (Vec<_>, Vec<_>) =
            (list.iter().cloned()).partition(|instance| placed_by(instance).is_some());
        *list = others.into_iter().collect();
        let own = list_of(root).iter().enumerate();
        let own = own.filter_map(|(i, instance)| Some((overlay::name_of(instance)?.to_owned(), i)));
        let own: HashMap<_, _> = own.collect();
        for instance in scenes {
            self.place(root, &own, instance, folder);
        }
    }

    /// Adds a tree that is placed as a group to the size of all; false if they become too large, which is
    /// reported for the first that is too much.
    fn take(&mut self, tree: &Node, group: &str, at: &Range<usize>) -> bool {
        let before = self.size.excess();
        self.size.add(tree);
        if let Content::Table(tables) = tree.get_ref() {
            let entries: usize = (tables.values())
                .map(|node| match node.get_ref() {
                    Content::Table(entries) => entries.len(),
                    Content::Array(items) => items.len(),
                    _ => 0,
                })
                .sum();
            self.size.text_bytes += entries * (group.len() + 1);
        }
        let Some(excess) = self.size.excess() else {
            return true;
        };
        if before.is_none() {
            let message = format!("with this scene, all placed scenes have more than {excess}");
            let error = self.report.error("scene-too-large", at, message);
            error.help = Some("place fewer or smaller scenes; a scene that is placed in several places counts each time".into());
        }
        self.left = 0;
        self.report.note_lacking_names();
        false
    }

    /// The file of a scene to place, unless it cannot be placed, which is reported.
    fn file(&mut self, folder: &str, name: &str, at: &Range<usize>) -> Option<&'p PlacedFile> {
        let Some(file) = self.placed.file(folder, name) else {
            if !self.placed.is_missing(folder, name) {
                let message = "a scene can be placed by scene text only";
                let error = self.report.error("placed-scene", at, message);
                error.help =
                    Some("write the `[[instance]]` in a file, not in `setup` or `--set`".into());
            }
            self.report.note_lacking_names();
            return None;
        };
        if self.above.contains(&file.file.path.as_path()) {
            return None; // a circle, which was reported when the files were read
        }
        if self.left == 0 {
            if self.size.excess().is_none() {
                let message = format!("at most {MOST_PLACED} scenes can be placed in a scene");
                self.report.error("too-many-files", at, message);
                self.report.note_lacking_names();
            }
            return None;
        }
        Some(file)
    }

    /// Adds a placed scene to a tree whose own instances are `own`, by name.
    fn place(
        &mut self,
        root: &mut Entries,
        own_instances: &HashMap<String, usize>,
        instance: Node,
        folder: &str,
    ) {
        let Some((name, node)) = placed_by(&instance) else {
            return;
        };
        let at = node.span();
        let Some(file) = self.file(folder, name, &at) else {
            return;
        };
        self.left -= 1;
        let stem = file.stem().to_owned();
        let Content::Table(mut group) = instance.into_inner() else {
            return;
        };
        let given = self.params_of(group.remove("model"));
        let own = group.remove("name");
        let own = own.and_then(|node| Some((node.get_ref().as_str()?.to_owned(), node.span())));
        let (name, at) = own.unwrap_or((stem, at));
        for key in OF_MODELS {
            if let Some((key, _)) = group.remove_entry(key) {
                let message = format!("`{}` does not apply to a placed scene", key.get_ref());
                let error = self.report.error("unknown-key", &key.span(), message);
                error.help = Some("write it in the instances of that scene".into());
            }
        }
        let inherited: Vec<_> = (INHERITED.iter())
            .filter_map(|key| group.remove_entry(*key))
            .collect();
        let outer = self.report.swap_unplaced(HashSet::new());
        let mut tree = self.tree(file);
        let unplaced = self.report.swap_unplaced(outer);
        let params = self.read_params(&mut tree, given);
        let mut own = PlacedGroup {
            name: name.clone(),
            at: self.report.span(&at),
            params,
            script: None,
        };
        own.script = self.run_script(&mut tree, file, &own.params);
        if !self.take(&tree, &name, &at) {
            return;
        }
        if let Content::Table(tree) = tree.get_mut() {
            let inner = self.groups.len();
            self.above.push(&file.file.path);
            self.expand(tree, &file.folder);
            self.above.pop();
            if self.size.excess().is_some() {
                return; // the scene is refused, whatever the tree has
            }
            for group in &mut self.groups[inner..] {
                group.name = format!("{name}.{}", group.name);
            }
            self.groups.push(own);
            let prefix = Prefix {
                group: &name,
                file,
                placed: self.placed,
                at: at.clone(),
                inherited: &inherited,
                unplaced: &unplaced,
            };
            prefix.apply(tree, self.report);
        }
        self.add_group(root, &name, at, group);
        if let Content::Table(tree) = tree.into_inner() {
            merge(Some(Below::scene()), root, tree, own_instances);
        }
    }

    /// The `params` of `model = { scene = "car.toml", params = { … } }`.
    fn params_of(&mut self, model: Option<Node>) -> Option<Node> {
        let Content::Table(mut model) = model?.into_inner() else {
            return None;
        };
        let params = model.remove("params");
        for key in model.keys().filter(|key| key.get_ref() != "scene") {
            let name = key.get_ref();
            let message = format!("{} is no key of a placed scene", suggest::key(name));
            let help = suggest::hint(name, &["scene", "params"], suggest::key, "the keys are");
            let error = self.report.error("unknown-key", &key.span(), message);
            error.help = Some(help);
        }
        params
    }

    /// The tree of a placed file, with its bases and included files.
    fn tree(&mut self, file: &PlacedFile) -> Node {
        let (tree, more) = syntax_errors::tree(&file.file.source, self.report);
        self.shadows.extend(more);
        let start = self.report.start_of(&file.file.source);
        let mut tree = Node::new(start..start, Content::Table(tree));
        include::merge(&mut tree, &file.included, self.shadows, self.report);
        layers::merge(tree, &file.bases, self.shadows, self.report)
    }

    fn add_group(
        &mut self,
        root: &mut Entries,
        name: &str,
        at: std::ops::Range<usize>,
        group: Entries,
    ) {
        let key = text("group".to_owned(), at.clone());
        let groups = root.entry(key);
        let groups =
            groups.or_insert_with(|| Node::new(at.clone(), Content::Table(Entries::new())));
        let Content::Table(groups) = groups.get_mut() else {
            return; // its reader reports this
        };
        if groups.contains_key(name) {
            let message = format!(
                "two groups or placed scenes are named {}",
                suggest::text(name)
            );
            let error = self.report.error("duplicate-name", &at, message);
            error.help = Some("give each `[[instance]]` that places a scene its own `name`".into());
            return;
        }
        let node = Node::new(at.clone(), Content::Table(group));
        groups.insert(text(name.to_owned(), at), node);
    }
}

/// The instances of a tree.
fn list_of(root: &Entries) -> &[Node] {
    let list = root.get("instance").and_then(|n| n.get_ref().as_array());
    list.map_or(&[], Vec::as_slice)
}

/// Adds the entries of a placed scene; entries of the scene itself with the same names lie over them.
fn merge(
    place: Option<Below>,
    root: &mut Entries,
    tree: Entries,
    own_instances: &HashMap<String, usize>,
) {
    for (kind, node) in tree {
        let place = content_below(place, kind.get_ref());
        let Some(own) = root.get_mut(kind.get_ref().as_str()).map(Node::get_mut) else {
            root.insert(kind, node);
            continue;
        };
        match (own, node.into_inner()) {
            (Content::Table(kinds), Content::Table(more)) if kind.get_ref() == "motion" => {
                merge(place, kinds, more, own_instances);
            }
            (Content::Table(own), Content::Table(more)) => {
                for (name, thing) in more {
                    let above = own.remove(name.get_ref().as_str());
                    let place = content_below(place, name.get_ref());
                    own.insert(name, over(place, thing, above));
                }
            }
            (Content::Array(own), Content::Array(more)) => {
                for thing in more {
                    let name = overlay::name_of(&thing);
                    let known = name.and_then(|name| own_instances.get(name));
                    match known.and_then(|index| own.get_mut(*index)) {
                        Some(above) => *above = over(place, thing, Some(above.clone())),
                        None => own.push(thing),
                    }
                }
            }
            _ => {} // its reader reports this
        }
    }
}

/// Lays an entry, if there is one, over another of the same name.
fn over(place: Option<Below>, below: Node, above: Option<Node>) -> Node {
    let Some(above) = above else {
        return below;
    };
    let at = below.span();
    match (below.into_inner(), above.into_inner()) {
        (Content::Table(mut below), Content::Table(above)) => {
            overlay::overlay_at(place, &mut below, above);
            Node::new(at, Content::Table(below))
        }
        (_, above) => Node::new(at, above),
    }
}
