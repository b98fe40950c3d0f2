//! Renaming of a placed scene's entries, of references to them, and of names of files.

use std::{collections::HashSet, ops::Range};

use super::{Placed, PlacedFile};
use crate::parse::{entry_kinds::ENTRY_KINDS, tables::Below};
use crate::range::ANY;
use crate::syntax::{Content, Entries, Key, Node};
use crate::table::{
    key_recorder::KeyRecord, report::Report, value::Named, value::Value as _, value::Version,
};

/// Tables that are placed with a scene beside [`ENTRY_KINDS`]; the others are about its image or its timeline.
const ALSO_PLACED: [&str; 2] = ["instance", "motion"];

/// Kind of entries that are not placed: probes belong to the scene whose reflections they serve.
const NOT_PLACED: &str = "probe";

/// A key with its place.
pub fn text(value: String, at: Range<usize>) -> Key {
    Key::new(at, value)
}

/// Renaming of one placed scene.
pub struct Prefix<'a> {
    /// Name of the group that stands for the scene.
    pub group: &'a str,
    /// File of the placed scene.
    pub file: &'a PlacedFile,
    /// All files of placed scenes.
    pub placed: &'a Placed,
    /// Place of the text that places it.
    pub at: Range<usize>,
    /// Models whose instances a layer of the scene has removed.
    pub unplaced: &'a HashSet<String>,
    /// Keys of the placing instance, for instances of the scene that lack them.
    pub inherited: &'a [(Key, Node)],
}

impl Prefix<'_> {
    /// Renames everything in a scene's tree, and makes the group the parent of entries without one.
    pub fn apply(&self, tree: &mut Entries, report: &mut Report) {
        if let Some(version) = tree.get("version") {
            let named = Named {
                key: "version",
                range: &ANY,
            };
            Version::read(version, &named, report);
        }
        let of_picture: Vec<_> = (tree.keys())
            .map(|key| key.get_ref().to_string())
            .filter(|key| {
                let mut placed = ENTRY_KINDS.iter().chain(&ALSO_PLACED);
                key == NOT_PLACED || !placed.any(|placed| placed == key)
            })
            .collect();
        for key in of_picture {
            tree.remove(key.as_str());
        }
        self.place_free_models(tree, report);
        self.content(Below::scene(), tree);
        for kind in ENTRY_KINDS {
            if let Some(Content::Table(entries)) = tree.get_mut(kind).map(Node::get_mut) {
                for (_, node) in entries.iter_mut() {
                    self.entry(kind, node);
                }
                self.rename(entries);
            }
        }
        if let Some(Content::Array(list)) = tree.get_mut("instance").map(Node::get_mut) {
            for node in list.iter_mut() {
                self.entry("instance", node);
            }
        }
        if let Some(Content::Table(kinds)) = tree.get_mut("motion").map(Node::get_mut) {
            for (_, node) in kinds.iter_mut() {
                if let Content::Table(entries) = node.get_mut() {
                    self.rename(entries);
                }
            }
        }
    }

    /// Adds an instance at the origin for each model that no instance names.
    fn place_free_models(&self, tree: &mut Entries, report: &Report) {
        let model = |instance: &Node| {
            let name = instance.get_ref().as_table()?.get("model")?;
            name.get_ref().as_str().map(str::to_owned)
        };
        let list = tree.get("instance").and_then(|n| n.get_ref().as_array());
        let used: HashSet<_> = list.into_iter().flatten().filter_map(model).collect();
        let models = tree.get("model").and_then(|n| n.get_ref().as_table());
        let models = models.into_iter().flat_map(|all| all.keys());
        let is_free = |key: &&Key| {
            let is_included = self.file.includes(&report.span(&key.span()));
            let name = key.get_ref().as_str();
            !used.contains(name) && !self.unplaced.contains(name) && !is_included
        };
        let free: Vec<_> = (models.filter(is_free))
            .map(|key| (key.get_ref().to_string(), key.span()))
            .collect();
        if free.is_empty() {
            return;
        }
        let list = tree
            .entry(text("instance".to_owned(), self.at.clone()))
            .or_insert_with(|| Node::new(self.at.clone(), Content::Array(<_>::default())));
        if let Content::Array(list) = list.get_mut() {
            for (name, at) in free {
                let mut instance = Entries::new();
                let model = Node::new(at.clone(), Content::String(name));
                instance.insert(text("model".to_owned(), at.clone()), model);
                list.push(Node::new(at, Content::Table(instance)));
            }
        }
    }

    /// Name of an entry of the scene, with the group's name before it.
    fn named(&self, name: &str) -> String {
        format!("{}.{name}", self.group)
    }

    fn rename(&self, entries: &mut Entries) {
        let all = std::mem::take(entries);
        for (key, node) in all {
            let name = self.named(key.get_ref());
            entries.insert(text(name, key.span()), node);
        }
    }

    /// Renames references and names of files in the table at a place.
    fn content(&self, place: Below, table: &mut Entries) {
        for (name, node) in table.iter_mut() {
            if let Some(key) = place.key(name.get_ref()) {
                self.refer(key, node);
            }
            match (place.below(name.get_ref()), node.get_mut()) {
                (Some(place), Content::Table(table)) => self.content(place, table),
                (Some(place), Content::Array(list)) => {
                    let tables = list.iter_mut().filter_map(|node| match node.get_mut() {
                        Content::Table(table) => Some(table),
                        _ => None, // its reader reports this
                    });
                    tables.for_each(|table| self.content(place, table));
                }
                _ => {}
            }
        }
    }

    /// Renames the entries or files that the text of a key names, or the texts of its array.
    fn refer(&self, key: &KeyRecord, node: &mut Node) {
        match node.get_mut() {
            Content::Array(list) => list.iter_mut().for_each(|node| self.refer(key, node)),
            Content::String(name) if !key.entries.is_empty() => *name = self.named(name),
            Content::String(name) if !key.files.is_empty() => *name = self.file_name(name),
            _ => {}
        }
    }

    /// Renames an instance, and gives entries that lack them keys of the placing instance, and the group.
    fn entry(&self, kind: &str, node: &mut Node) {
        let Content::Table(table) = node.get_mut() else {
            return; // its reader reports this
        };
        if kind == "instance" {
            if let Some(Content::String(name)) = table.get_mut("name").map(Node::get_mut) {
                *name = self.named(name);
            }
            for (key, node) in self.inherited {
                if !table.contains_key(key.get_ref().as_str()) {
                    table.insert(key.clone(), node.clone());
                }
            }
        }
        if kind == "decal" {
            self.attach(table, "only");
        }
        if !["material", "model"].contains(&kind) {
            self.attach(table, "parent");
        }
    }

    /// Names the group in a key that a table lacks.
    fn attach(&self, table: &mut Entries, key: &str) {
        if !table.contains_key(key) {
            let group = Content::String(self.group.to_owned());
            let key = text(key.to_owned(), self.at.clone());
            table.insert(key, Node::new(self.at.clone(), group));
        }
    }

    fn file_name(&self, name: &str) -> String {
        self.placed.file_name(&self.file.folder, name)
    }
}
