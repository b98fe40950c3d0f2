//! Names that scenes define, with their places: in a text, its bases, and the files that it includes.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use super::outline::{Part, outline};
use crate::{
    runtime::scene_text::asset_folders,
    scene::{
        dependencies::Dependencies,
        parse::{self, ReadOptions, Texts},
    },
};

/// Tables whose entries have names that other tables use.
const NAMED: [&str; 7] = [
    "camera", "group", "light", "material", "model", "params", "variant",
];

/// A defined name with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// Kind of the named item: a table such as `material`, or `instance`.
    pub kind: String,
    /// The name.
    pub name: String,
    /// Byte range of the name in the text.
    pub range: Range<usize>,
}

/// A text file in the editor or on disk.
#[derive(Clone, Debug)]
pub struct TextFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Text of the file, as edited.
    pub text: String,
}

/// Names that a text defines.
pub fn names(text: &str) -> Vec<Name> {
    let words = outline(text).0.into_iter();
    let name = |word: super::outline::Word| {
        let kind = match (&word.part, word.table.as_slice()) {
            (Part::Header, [kind]) if NAMED.contains(&kind.as_str()) => kind.clone(),
            (Part::Key, [kind]) if kind == "params" => kind.clone(),
            (Part::Value(key), [kind]) if kind == "instance" && key == "name" => kind.clone(),
            _ => return None,
        };
        let (name, range) = (word.text, word.range);
        Some(Name { kind, name, range })
    };
    words.filter_map(name).collect()
}

/// The text, its bases and all scene text files that these include; the text itself comes first.
pub fn with_parts(path: &Path, text: &str) -> Vec<TextFile> {
    let found = Dependencies::default();
    let options = ReadOptions {
        assets: asset_folders(&[]),
        ..ReadOptions::default()
    };
    let _ = Texts::collect(text, path, &options, &found); // the check reports errors
    let mut all = vec![TextFile {
        path: path.to_owned(),
        text: text.to_owned(),
    }];
    let is_scene = |p: &PathBuf| p.extension().is_some_and(|e| e == "toml") && p.is_file();
    for path in found.paths().into_iter().filter(is_scene) {
        if let Ok(text) = parse::read(&path) {
            all.push(TextFile { path, text });
        }
    }
    all
}

/// Kinds of [`Name`] that the value of a key refers to; empty if it refers to none.
pub fn kinds_of_value(key: &str) -> &'static [&'static str] {
    match key {
        "model" => &["model"],
        "material" | "extends" => &["material"],
        "instance" | "parent" => &["instance", "group"],
        "camera" => &["camera"],
        _ => &[],
    }
}

/// Extensions of the files that the value of a key in a table names; empty if it names none.
pub fn files_of_value(table: &[String], key: &str) -> &'static [&'static str] {
    match (table.first().map(String::as_str), key) {
        (None, "base" | "include") => &["toml"],
        (None, "script") => &["rhai"],
        (Some("instance"), "instances_from") => &["csv"],
        (_, "scene") => &["toml"],
        (Some("environment"), "file") => &["hdr", "exr"],
        (Some("model"), "file") if table.last().is_some_and(|last| last == "shape") => {
            &["png", "jpg", "jpeg", "webp"]
        }
        (Some("model"), "file") => &["gltf", "glb", "usd", "usda", "usdc", "usdz"],
        (_, key) if key.ends_with("_texture") => &["png", "jpg", "jpeg", "webp", "ktx2"],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_tables_and_instances_are_found() {
        let text = "[material.\"old brass\"]\n[[instance]]\nname = 'ball'\n[params]\nlift = 1\n[material.x.y]\n";
        let found = names(text);
        let found: Vec<_> = found
            .iter()
            .map(|n| (n.kind.as_str(), n.name.as_str()))
            .collect();
        let want = [
            ("material", "old brass"),
            ("instance", "ball"),
            ("params", "lift"),
            ("material", "x"),
        ];
        assert_eq!(found, want);
    }
}
