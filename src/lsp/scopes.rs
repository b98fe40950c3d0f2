//! Files of a scene, with the prefix that names of placed scenes have in it.

use std::{
    ops::Range,
    path::{Component, Path, PathBuf},
    sync::Arc,
};

use serde_json::Value;

use super::{
    names::{Name, names, with_parts},
    outline::{Part, words},
    position::location,
};
use reflet_scene::diagnostic::Source;

/// Most scenes in scenes that are followed, and most files.
const DEPTH: usize = 8;
const MOST_FILES: usize = 200;

/// A file of a scene.
#[derive(Clone, Debug)]
pub struct Scoped {
    /// Beginning of names of the file in the scene's text: nothing, or the groups of placed scenes, each with a dot.
    pub prefix: String,
    /// The file.
    pub source: Arc<Source>,
}

impl Scoped {
    /// Whether names of this kind are seen in the scene: a placed scene keeps its parameters and variants to itself.
    pub fn shows(&self, kind: &str) -> bool {
        self.prefix.is_empty() || !["params", "variant", "probe"].contains(&kind)
    }
}

/// A scene that another one places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Placement {
    /// Group that stands for the scene: the name of the instance, else of the file.
    pub group: String,
    /// File of the scene, as it is named.
    pub file: String,
}

/// The text, its bases, what these include, and the scenes that they place; the text itself comes first.
pub fn with_scopes(own: &Arc<Source>) -> Vec<Scoped> {
    let mut all = Vec::new();
    add(own, "", &with_parts(own), DEPTH, &mut all);
    all
}

fn add(
    source: &Arc<Source>,
    prefix: &str,
    parts: &[Arc<Source>],
    depth: usize,
    all: &mut Vec<Scoped>,
) {
    let is_known = |known: &Scoped| known.prefix == prefix && known.source.path == source.path;
    if depth == 0 || all.len() >= MOST_FILES || all.iter().any(is_known) {
        return;
    }
    all.push(Scoped {
        prefix: prefix.to_owned(),
        source: Arc::clone(source),
    });
    let find = |name: &str| parts.iter().find(|part| is_named(&part.path, name));
    for name in layers(source) {
        if let Some(part) = find(&name) {
            add(part, prefix, parts, depth - 1, all);
        }
    }
    for Placement { group, file } in placements(source) {
        if let Some(part) = find(&file) {
            let prefix = format!("{prefix}{group}.");
            add(part, &prefix, parts, depth - 1, all);
        }
    }
}

/// Whether a path may be meant by a file name in a text, from whatever folder the name starts.
pub fn is_named(path: &Path, name: &str) -> bool {
    let parts = Path::new(name).components();
    let below: PathBuf = parts
        .filter(|part| matches!(part, Component::Normal(_)))
        .collect();
    !below.as_os_str().is_empty() && path.ends_with(below)
}

/// Names of the base and of the included files of a text.
fn layers(source: &Source) -> Vec<String> {
    let words = words(source).into_iter();
    let is_layer =
        |part: &Part| matches!(part, Part::Value(key) if key == "base" || key == "include");
    words
        .filter(|word| word.table.is_empty() && is_layer(&word.part))
        .map(|word| word.text)
        .collect()
}

/// Scenes that a text places: `[[instance]]` with `model = { scene = "….toml" }`.
pub fn placements(source: &Source) -> Vec<Placement> {
    let mut all = Vec::new();
    let (mut name, mut scene) = (None::<String>, None::<String>);
    let mut end = |name: &mut Option<String>, scene: &mut Option<String>| {
        let own = name.take();
        if let Some(file) = scene.take() {
            let stem = Path::new(&file).file_stem();
            let stem = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            let group = own.unwrap_or(stem);
            all.push(Placement { group, file });
        }
    };
    for word in words(source) {
        let table: Vec<&str> = word.table.iter().map(String::as_str).collect();
        match (&word.part, table.as_slice()) {
            (Part::Header, []) => end(&mut name, &mut scene),
            (Part::Value(key), ["instance"]) if key == "name" => name = Some(word.text),
            (Part::Value(key), ["instance", "model"]) if key == "scene" => scene = Some(word.text),
            _ => {}
        }
    }
    end(&mut name, &mut scene);
    all
}

/// Definitions of the name in these files, of a kind that `is_kind` accepts.
pub fn definitions(
    files: &[Scoped],
    name: &str,
    is_kind: impl Fn(&str) -> bool,
) -> Vec<(Arc<Source>, Name)> {
    let mut all = Vec::new();
    for part in files {
        let Some(name) = name.strip_prefix(part.prefix.as_str()) else {
            continue;
        };
        let file = &part.source;
        let given = names(file).into_iter();
        let given = given.filter(|n| n.name == name && is_kind(&n.kind) && part.shows(&n.kind));
        all.extend(given.map(|name| (Arc::clone(file), name)));
    }
    all
}

/// Locations of [`definitions`].
pub fn places(files: &[Scoped], name: &str, is_kind: impl Fn(&str) -> bool) -> Vec<Value> {
    let all = definitions(files, name, is_kind).into_iter();
    all.map(|(file, name)| location(&file, &name.range))
        .collect()
}

/// A name behind the groups of placed scenes: its own byte range in the name, the range of each group, and the file
/// that the innermost group places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split<'a> {
    /// The name without groups.
    pub name: &'a str,
    /// Where it begins in the whole name, bytes.
    pub start: usize,
    /// Groups before it, each with its range in the whole name.
    pub groups: Vec<(&'a str, Range<usize>)>,
    /// File of the scene that has the name.
    pub file: &'a str,
}

/// Divides a name such as `lamp.bulb` where `lamp` is a placed scene.
pub fn split<'a>(whole: &'a str, placements: &'a [Placement]) -> Option<Split<'a>> {
    let mut found: Option<Split<'a>> = None;
    loop {
        let so_far = found.as_ref();
        let (start, depth) = so_far.map_or((0, 0), |split| (split.start, split.groups.len()));
        let rest = &whole[start..];
        let is_before = |placement: &&Placement| {
            let name = rest.strip_prefix(placement.group.as_str());
            let name = name.and_then(|name| name.strip_prefix('.'));
            name.is_some_and(|name| !name.is_empty())
        };
        let next = placements.iter().find(is_before);
        let Some(placement) = next.filter(|_| depth < DEPTH) else {
            return found;
        };
        let end = start + placement.group.len();
        let mut groups = found.map_or_else(Vec::new, |split| split.groups);
        groups.push((&whole[start..end], start..end));
        found = Some(Split {
            name: &whole[end + 1..],
            start: end + 1,
            groups,
            file: &placement.file,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_behind_groups_are_divided() {
        let text = "[[instance]]\nmodel = { scene = \"lib/lamp.toml\" }\n[[instance]]\nname = \"left\"\n\
                    model = { scene = \"lib/lamp.toml\", params = { on = true } }\n[[instance]]\nmodel = \"a\"\n";
        let all = placements(&Source::new("a.toml", text));
        let groups: Vec<_> = all.iter().map(|placed| placed.group.as_str()).collect();
        assert_eq!(groups, ["lamp", "left"]);
        let found = split("left.lamp.bulb", &all).expect("two groups");
        let parts = (found.name, found.start, found.groups.len());
        assert_eq!(parts, ("bulb", 10, 2));
        assert_eq!(split("lefty.bulb", &all), None);
        assert_eq!(split("left.", &all), None);
        let path = Path::new("/show/lib/lamp.toml");
        assert!(is_named(path, "../lib/lamp.toml") && !is_named(path, "amp.toml"));
    }
}
