//! Names that scenes define, with their places: in a text, its bases, and the files that it includes.

use std::{ops::Range, path::Path, sync::Arc};

use super::outline::{Part, Word, words};
use reflet_render::runtime::scene_options::border;
use reflet_scene::{
    diagnostic::Source,
    parse::{
        Texts,
        entry_kinds::ENTRY_KINDS,
        recorded_keys,
        tables::{Manual, keys_of},
    },
    project::ProjectChoice,
    reach::Border,
};

/// Tables whose entries have names that other tables use.
fn is_named(table: &str) -> bool {
    ENTRY_KINDS.contains(&table) || ["params", "variant"].contains(&table)
}

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

impl Name {
    /// The name at another place of its text.
    pub fn at(&self, range: Range<usize>) -> Self {
        Self {
            range,
            ..self.clone()
        }
    }
}

/// Names that a text defines.
pub fn names(source: &Source) -> Vec<Name> {
    let words = words(source).into_iter();
    let name = |word: Word| {
        let kind = match (&word.part, word.table.as_slice()) {
            (Part::Header, [kind]) if is_named(kind) => kind.clone(),
            // [params], and `material.brass = { … }`.
            (Part::Key, [kind]) if is_named(kind) => kind.clone(),
            (Part::Value(key), [kind]) if kind == "instance" && key == "name" => kind.clone(),
            _ => return None,
        };
        let (name, range) = (word.text, word.range);
        Some(Name { kind, name, range })
    };
    words.filter_map(name).collect()
}

/// Names of a text that refer to definitions elsewhere, each with its possible kinds.
pub fn uses(source: &Source) -> Vec<(Name, Vec<String>)> {
    let one = |word: Word| {
        let owned = |kinds: &[&str]| kinds.iter().map(|kind| (*kind).to_owned()).collect();
        let table: Vec<&str> = word.table.iter().map(String::as_str).collect();
        let kinds: Vec<String> = match (&word.part, table.as_slice()) {
            (Part::Value(key), [] | ["variant", _]) if key == "remove" => {
                let (kind, _) = word.text.split_once('.')?;
                vec![kind.to_owned()]
            }
            (Part::Value(key), _) => owned(kinds_of_value(key)),
            (Part::Header | Part::Key, ["motion", kind] | ["variant", _, kind]) => owned(&[kind]),
            (Part::Header | Part::Key, ["variant", _, "motion", kind]) => owned(&[kind]),
            _ => return None,
        };
        let text = match &word.part {
            Part::Value(key) if key == "remove" => word.text.split_once('.')?.1.to_owned(),
            _ => word.text,
        };
        let is_use = !kinds.is_empty() && kinds.iter().any(|kind| is_named(kind));
        is_use.then_some((
            Name {
                kind: String::new(),
                name: text,
                range: word.range,
            },
            kinds,
        ))
    };
    words(source).into_iter().filter_map(one).collect()
}

/// The text, its bases, and all scene text files that these include or place; the text itself comes first.
pub fn with_parts(own: &Arc<Source>) -> Vec<Arc<Source>> {
    let texts = Texts::collect(Arc::clone(own), &border_of(&own.path)); // the check reports errors
    let files = texts.files().map(|file| &file.source);
    std::iter::once(own).chain(files).cloned().collect()
}

/// Folders that a file may read besides its own; mistakes in its project are reported by the check.
pub fn border_of(path: &Path) -> Border {
    let project = ProjectChoice::Search.project_of(path);
    border(&[], project.ok().flatten().as_ref())
}

/// Kinds of [`Name`] that the value of a key refers to; empty if it refers to none.
pub fn kinds_of_value(key: &str) -> &'static [&'static str] {
    let mut all = recorded_keys().iter().flat_map(keys_of);
    let named = all.find(|(_, known)| known.name == key && !known.entries.is_empty());
    named.map_or(&[], |(_, known)| known.entries)
}

/// Extensions of the files that the value of a key in a table of a file names; empty if it names none.
pub fn files_of_value(file: &Path, table: &[String], key: &str) -> &'static [&'static str] {
    let known = Manual::for_file(file).key(table, key);
    known.map_or(&[], |(_, _, known)| known.files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_tables_and_instances_are_found() {
        let text = "[material.\"old brass\"]\n[[instance]]\nname = 'ball'\n[params]\nlift = 1\n[material.x.y]\n";
        let found = names(&Source::new("a.toml", text));
        let found = found.iter().map(|n| format!("{} {}", n.kind, n.name));
        let found = found.collect::<Vec<_>>().join(", ");
        assert_eq!(
            found,
            "material old brass, instance ball, params lift, material x"
        );
    }
}
