//! Renaming of a placed scene's entries, of references to them, and of names of files.

use std::{collections::HashSet, ops::Range};

use super::{Placed, PlacedFile};
use crate::parse::entry_kinds::ENTRY_KINDS;
use crate::range::ANY;
use crate::syntax::{Content, Entries, Key, Node};
use crate::table::{report::Report, value::Named, value::Value as _, value::Version};

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
                    entries.iter_mut().for_each(|(_, node)| self.followed(node));
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

    /// Changes the text of a key, if it has one.
    fn change(table: &mut Entries, key: &str, new: impl FnOnce(&str) -> String) {
        if let Some(node) = table.get_mut(key)
            && let Content::String(old) = node.get_mut()
        {
            *old = new(old);
        }
    }

    /// Renames the files of a shape and of its parts.
    fn shape(&self, shape: &mut Entries) {
        for key in ["file", "font"] {
            Self::change(shape, key, |name| self.file_name(name));
        }
        if let Some(Content::Table(inner)) = shape.get_mut("shape").map(Node::get_mut) {
            self.shape(inner);
        }
        let parts = shape.get_mut("parts").map(Node::get_mut);
        let Some(Content::Array(parts)) = parts else {
            return;
        };
        for part in parts {
            if let Content::Table(part) = part.get_mut()
                && let Some(Content::Table(shape)) = part.get_mut("shape").map(Node::get_mut)
            {
                self.shape(shape);
            }
        }
    }

    /// Renames references, names of files and the parent in one table.
    fn entry(&self, kind: &str, node: &mut Node) {
        let Content::Table(table) = node.get_mut() else {
            return; // its reader reports this
        };
        match kind {
            "material" => self.material(table),
            "model" => {
                Self::change(table, "material", |name| self.named(name));
                Self::change(table, "file", |name| self.file_name(name));
                if let Some(Content::Table(shape)) = table.get_mut("shape").map(Node::get_mut) {
                    self.shape(shape);
                }
                if let Some(Content::Table(all)) = table.get_mut("material").map(Node::get_mut) {
                    for (_, node) in all.iter_mut() {
                        if let Content::Table(material) = node.get_mut() {
                            self.material(material);
                        }
                    }
                }
            }
            "instance" => {
                for key in ["name", "model", "material"] {
                    Self::change(table, key, |name| self.named(name));
                }
                Self::change(table, "instances_from", |name| self.file_name(name));
                if let Some(Content::Table(over)) = table.get_mut("over").map(Node::get_mut) {
                    Self::change(over, "model", |name| self.named(name));
                }
                if let Some(Content::Table(own)) = table.get_mut("material").map(Node::get_mut) {
                    self.material(own);
                }
                for (key, node) in self.inherited {
                    if !table.contains_key(key.get_ref().as_str()) {
                        table.insert(key.clone(), node.clone());
                    }
                }
                self.attach(table);
            }
            "decal" => {
                Self::change(table, "material", |name| self.named(name));
                self.projected_onto(table);
                self.attach(table);
            }
            _ => self.attach(table),
        }
    }

    /// Renames the instances and groups onto which a decal is projected; without any, all of the scene.
    fn projected_onto(&self, decal: &mut Entries) {
        match decal.get_mut("only").map(Node::get_mut) {
            Some(Content::Array(names)) => {
                for name in names {
                    if let Content::String(name) = name.get_mut() {
                        *name = self.named(name);
                    }
                }
            }
            Some(_) => Self::change(decal, "only", |name| self.named(name)),
            None => {
                let group = Content::String(self.group.to_owned());
                let key = text("only".to_owned(), self.at.clone());
                decal.insert(key, Node::new(self.at.clone(), group));
            }
        }
    }

    fn attach(&self, table: &mut Entries) {
        if table.contains_key("parent") {
            return Self::change(table, "parent", |name| self.named(name));
        }
        let group = Content::String(self.group.to_owned());
        let key = text("parent".to_owned(), self.at.clone());
        table.insert(key, Node::new(self.at.clone(), group));
    }

    fn material(&self, table: &mut Entries) {
        Self::change(table, "extends", |name| self.named(name));
        let textures: Vec<_> = (table.keys())
            .map(|key| key.get_ref().to_string())
            .filter(|key| key.ends_with("_texture"))
            .collect();
        for key in textures {
            Self::change(table, &key, |name| self.file_name(name));
        }
    }

    fn file_name(&self, name: &str) -> String {
        self.placed.file_name(&self.file.folder, name)
    }

    /// Renames the instances that tracks follow.
    fn followed(&self, node: &mut Node) {
        let Content::Table(tracks) = node.get_mut() else {
            return;
        };
        for (_, track) in tracks.iter_mut() {
            let Content::Table(track) = track.get_mut() else {
                continue;
            };
            if let Some(Content::Table(follow)) = track.get_mut("follow").map(Node::get_mut) {
                Self::change(follow, "instance", |name| self.named(name));
            }
        }
    }
}
