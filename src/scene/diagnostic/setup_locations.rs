//! Place in a script of a mistake in the result of its `setup`. Values do not know where they were written,
//! so the place is found by the names on the path to the value.

use std::{
    ops::Range,
    sync::{
        Arc, OnceLock,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{Source, Span};
use crate::{
    suggest,
    syntax::{Content, Entries, Node},
    toml_text::floats_in,
};

/// Keys of the result of `setup`, the scene tables that they stand for, and whether they are lists.
pub const TABLES: [(&str, &str, bool); 8] = [
    ("cameras", "camera", false),
    ("materials", "material", false),
    ("models", "model", false),
    ("lights", "light", false),
    ("groups", "group", false),
    ("decals", "decal", false),
    ("probes", "probe", false),
    ("instances", "instance", true),
];

/// Number of entries before a place that are searched for one that contains it.
const NEAR: usize = 1000;
/// Number of mistakes whose places are looked up: a scene does not show more, and a script may be long.
const MOST: usize = 200;

/// Result of `setup`, as scene text that has no file of its own.
#[derive(Debug)]
pub struct Returned {
    /// The script's files, the script itself first.
    scripts: Vec<Arc<Source>>,
    /// Place of its function `setup`.
    setup: Span,
    /// Keys and values of the text, sorted by where they begin; made for the first mistake.
    entries: OnceLock<Vec<Entry>>,
    explained: AtomicUsize,
}

/// Lookup results are not copied: they can be made again.
impl Clone for Returned {
    fn clone(&self) -> Self {
        Self {
            scripts: self.scripts.clone(),
            setup: self.setup.clone(),
            entries: OnceLock::new(),
            explained: AtomicUsize::new(0),
        }
    }
}

impl PartialEq for Returned {
    fn eq(&self, other: &Self) -> bool {
        self.scripts == other.scripts && self.setup == other.setup
    }
}

impl Eq for Returned {}

/// A key or a value of the text.
#[derive(Debug, PartialEq, Eq)]
struct Entry {
    at: Range<usize>,
    /// Names and list indices on the path to it.
    path: Vec<String>,
    /// Range of the value; `None` for a table.
    value: Option<Range<usize>>,
}

impl Returned {
    /// Result of the `setup` at the span `setup` in the first of `scripts`.
    pub fn new(scripts: Vec<Arc<Source>>, setup: Span) -> Self {
        Self {
            scripts,
            setup,
            entries: OnceLock::new(),
            explained: AtomicUsize::new(0),
        }
    }

    /// Whether a span lies in one of the script's files.
    pub fn has(&self, at: &Span) -> bool {
        let source = at.source.as_ref();
        source.is_some_and(|s| self.scripts.iter().any(|own| Arc::ptr_eq(own, s)))
    }

    /// Place in the script of the range `at` of the text that it returned, and its description for messages.
    pub fn explain(&self, returned: &Source, at: &Range<usize>) -> (Span, String) {
        let text = returned.text.as_str();
        let entries = (self.entries).get_or_init(|| entries(returned.syntax().root()));
        let before = &entries[..entries.partition_point(|e| e.at.start <= at.start)];
        let is_shown = self.explained.fetch_add(1, Ordering::Relaxed) < MOST;
        let mut near = (before.iter().rev()).take(if is_shown { NEAR } else { 0 });
        let Some(found) = near.find(|e| at.start <= e.at.end) else {
            return (self.setup.clone(), "setup() returned".into());
        };
        let mut message = "setup() returned ".to_owned();
        for (i, name) in found.path.iter().enumerate() {
            let dot = if i == 0 || name.starts_with('[') {
                ""
            } else {
                "."
            };
            message += &format!("{dot}{}", suggest::clip(name));
        }
        if let Some(value) = found.value.clone().and_then(|value| text.get(value)) {
            match floats_in(value) {
                Some(count) => message += &format!(" with {count} numbers"),
                None => message += &format!(" = {}", suggest::clip(value)),
            }
        }
        let place = || self.place(&found.path);
        let written = self.written(text, entries, found);
        (written.unwrap_or_else(place), message)
    }

    /// Place of the key with exactly this value in the script: its only place, or, if it is written as often as it was
    /// returned, the place of the same number.
    fn written(&self, text: &str, entries: &[Entry], found: &Entry) -> Option<Span> {
        let key = found.path.last().filter(|name| !name.starts_with('['))?;
        let value = text.get(found.value.clone()?)?;
        let is_same = |e: &&Entry| {
            let own = e.value.clone().and_then(|value| text.get(value));
            e.path.len() == found.path.len() && e.path.last() == Some(key) && own == Some(value)
        };
        // A key and its value are two entries.
        let mut same: Vec<&Entry> = entries.iter().filter(is_same).collect();
        same.dedup_by(|a, b| a.path == b.path);
        let rank = same.iter().position(|e| e.path == found.path)?;
        let mut places = self.keys(key);
        places.retain(|(script, at)| has_value(&self.scripts[*script].text[at.end..], value));
        let index = match places.len() {
            1 => 0,
            n if n == same.len() => rank,
            _ => return None,
        };
        let (script, range) = places.swap_remove(index);
        Some(Span {
            source: Some(Arc::clone(&self.scripts[script])),
            range,
        })
    }

    /// Place of the value at a path of names, or else of `setup`.
    pub fn place(&self, path: &[String]) -> Span {
        self.locate(path).unwrap_or_else(|| self.setup.clone())
    }

    /// Place of the last name of a path, written as a key: the only one, or the first after the only place of
    /// the name before it.
    fn locate(&self, path: &[String]) -> Option<Span> {
        let mut names = path.iter().rev().filter(|name| !name.starts_with('['));
        let (last, above) = (names.next()?, names.next());
        let places = self.keys(last);
        let above = above.map_or_else(Vec::new, |above| self.keys(above));
        let inside = match above.as_slice() {
            [(script, outer)] => (places.iter())
                .find(|(other, at)| other == script && at.start > outer.start)
                .cloned(),
            _ => None,
        };
        let only = |mut places: Vec<_>| places.pop().filter(|_| places.is_empty());
        let (script, range) = inside.or_else(|| only(places)).or_else(|| only(above))?;
        Some(Span {
            source: Some(Arc::clone(&self.scripts[script])),
            range,
        })
    }

    /// Places where a name is written as a key, `name:` or `.name =`, with the index of the script.
    fn keys(&self, name: &str) -> Vec<(usize, Range<usize>)> {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let mut found = Vec::new();
        for (script, source) in self.scripts.iter().enumerate() {
            for (start, _) in source.text.match_indices(name) {
                let (before, after) = (&source.text[..start], &source.text[start + name.len()..]);
                if before.ends_with(is_word) || after.starts_with(is_word) {
                    continue;
                }
                let line = before.rsplit('\n').next().unwrap_or_default();
                let after = after.trim_start_matches(['"', '`']).trim_start();
                let is_set = after.starts_with('=') && !after.starts_with("==");
                let is_key = after.starts_with(':') && !after.starts_with("::");
                if !line.contains("//") && (is_key || (is_set && before.ends_with('.'))) {
                    found.push((script, start..start + name.len()));
                }
            }
        }
        found
    }
}

/// Whether the text after a key is this value.
fn has_value(after: &str, value: &str) -> bool {
    let after = after.trim_start_matches(['"', '`']).trim_start();
    let written = after.trim_start_matches([':', '=']).trim_start();
    let in_backticks = value.strip_prefix('"').and_then(|v| v.strip_suffix('"'));
    let in_backticks = in_backticks.map(|v| format!("`{v}`"));
    let rest = [Some(value), in_backticks.as_deref()];
    let mut rest = rest
        .into_iter()
        .flatten()
        .filter_map(|v| written.strip_prefix(v));
    rest.any(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || "_.".contains(c)))
}

/// Keys and values of a text, in order.
fn entries(root: &Entries) -> Vec<Entry> {
    let mut found = Vec::new();
    walk_table(root, &[], &mut found);
    // Entries that begin at the same place: the innermost comes last.
    found.sort_by_key(|entry: &Entry| (entry.at.start, std::cmp::Reverse(entry.at.end)));
    found
}

fn walk_table(table: &Entries, path: &[String], found: &mut Vec<Entry>) {
    for (key, node) in table {
        let name = key.get_ref().to_string();
        let name = if path.is_empty() { plural(&name) } else { name };
        let path = [path, &[name]].concat();
        let value = plain(node);
        found.push(Entry {
            at: key.span(),
            path: path.clone(),
            value,
        });
        walk(node, path, found);
    }
}

fn walk(node: &Node, path: Vec<String>, found: &mut Vec<Entry>) {
    match node.get_ref() {
        Content::Table(table) => walk_table(table, &path, found),
        Content::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                let path = [path.as_slice(), &[format!("[{i}]")]].concat();
                walk(item, path, found);
            }
        }
        _ => {}
    }
    found.push(Entry {
        at: node.span(),
        path,
        value: plain(node),
    });
}

fn plain(node: &Node) -> Option<Range<usize>> {
    let is_plain = match node.get_ref() {
        Content::Table(_) => false,
        Content::Array(items) => !items
            .iter()
            .any(|i| matches!(i.get_ref(), Content::Table(_))),
        _ => true,
    };
    is_plain.then(|| node.span())
}

/// Key in the result of `setup` for a table of the scene.
fn plural(table: &str) -> String {
    let known = TABLES.iter().find(|(_, own, _)| *own == table);
    known.map_or(table, |(key, ..)| key).to_owned()
}
