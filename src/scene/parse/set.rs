//! `--set path=value`: one value of the tree replaced before it is read, so that its mistakes get
//! the same messages, with the place in the text of the option.

use std::{ops::Range, sync::Arc};

use super::{
    entry_kinds::ENTRY_KINDS,
    rules::{Rules, content_below},
    syntax_errors::in_plain_words,
    tables::Below,
};
use crate::table::{params, report::Report};
use crate::{
    diagnostic::Source,
    suggest,
    syntax::{Content, Entries, Key, Node, SyntaxTree, moved, parse_value},
};

/// Keys that choose the files and variants of a scene; these are merged before values are set.
const LAYERS: [&str; 4] = ["base", "include", "remove", "variant"];

/// One name of a path, at its position.
struct Segment {
    name: String,
    at: Range<usize>,
}

/// Applies an override to the tree.
pub fn apply(root: &mut Node, source: &Arc<Source>, report: &mut Report) {
    let (text, base) = (source.text.as_str(), report.start_of(source));
    let Some(equals) = equals_sign(text) else {
        let error = report.error("bad-set", &(base..base + text.len()), "`=` is missing");
        error.help = Some(match text.split_once([' ', ':']) {
            Some((path, value)) => format!("write `--set {path}={}`", value.trim()),
            None => format!("write `--set {text}=VALUE`, such as `--set reflection.bounces=2`"),
        });
        return;
    };
    let path = segments(&text[..equals], base);
    let value = value(&text[equals + 1..], &text[..equals], base, report);
    let Some(path) = path.filter(|p| !p.is_empty()) else {
        let message = "the path before `=` must be names with dots between";
        let error = report.error("bad-set", &(base..base + equals.max(1)), message);
        error.help = Some("such as `camera.main.fov_deg` or `instance.0.scale`".into());
        return;
    };
    if LAYERS.contains(&path[0].name.as_str()) {
        let message = format!("{} cannot be set", suggest::key(&path[0].name));
        let error = report.error("bad-set", &path[0].at, message);
        error.help = Some("write it in the scene; keys of the files it names can be set".into());
    } else if let Some(value) = value {
        put(root, &path, value, report);
    }
}

/// The first `=` outside quotes.
fn equals_sign(text: &str) -> Option<usize> {
    let mut quote = None;
    text.char_indices().find_map(|(i, c)| {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if open == c => quote = None,
            (None, '=') => return Some(i),
            _ => {}
        }
        None
    })
}

/// The names of a path, without their places.
pub fn names_of(path: &str) -> Option<Vec<String>> {
    let segments = segments(path, 0)?;
    Some(segments.into_iter().map(|segment| segment.name).collect())
}

/// The names of a path; TOML's own reader splits them, so quotes work as they do in a scene.
fn segments(path: &str, base: usize) -> Option<Vec<Segment>> {
    let line = format!("{path} = 0");
    let tree = SyntaxTree::parse(&line);
    let mut segments = Vec::new();
    let mut level = tree.correct().ok()?;
    loop {
        if level.len() != 1 {
            return None;
        }
        let (key, node) = level.iter().next()?;
        let at = key.span();
        let name = key.get_ref().to_string();
        segments.push(Segment {
            name,
            at: base + at.start..base + at.end,
        });
        match node.get_ref() {
            Content::Table(next) => level = next,
            _ => return Some(segments),
        }
    }
}

/// The value of a path as TOML, or a bare word as text, since shells remove quotes.
fn value(text: &str, path: &str, base: usize, report: &mut Report) -> Option<Node> {
    let trimmed = text.trim();
    let start = base + path.len() + 1 + (text.len() - text.trim_start().len());
    let bare = |c: char| c.is_alphanumeric() || "_-./\\:* ".contains(c);
    match parse_value(trimmed) {
        Ok(node) => Some(moved(&node, start)),
        Err(_) if !trimmed.is_empty() && trimmed.trim_start_matches('#').chars().all(bare) => {
            let at = start..start + trimmed.len();
            Some(Node::new(at, Content::String(trimmed.into())))
        }
        Err(error) => {
            // With its key, as the key decides what is right.
            let before = format!("{} = ", path.trim());
            let in_line = before.len() + error.at.start..before.len() + error.at.end;
            let line = before.clone() + trimmed;
            let words = in_plain_words(&line, &in_line, &error.message, false);
            let at = words.at.unwrap_or(in_line);
            let moved = |end: usize| start + end.saturating_sub(before.len());
            let at = moved(at.start)..moved(at.end);
            report.error("bad-set", &at, words.message).help = words.help;
            None
        }
    }
}

fn put(root: &mut Node, path: &[Segment], value: Node, report: &mut Report) {
    let Some((last, above)) = path.split_last() else {
        return;
    };
    let (mut node, mut place) = (root, Some(Below::scene()));
    for (depth, segment) in above.iter().enumerate() {
        if node.get_ref().as_table().is_some() {
            place = content_below(place, &segment.name);
        }
        // A new name of an entry would most likely be a typing error.
        let named = depth == 1 && ENTRY_KINDS.contains(&above[0].name.as_str());
        let new = if named {
            New::Refused(&above[0].name)
        } else {
            New::Table
        };
        match step(node, segment, new, report) {
            Some(next) => node = next,
            None => return,
        }
    }
    let is_param = matches!(above, [params] if params.name == "params");
    if let Content::Table(table) = node.get_mut() {
        let key = Key::new(last.at.clone(), last.name.clone());
        if is_param {
            params::set(table, key, value, report);
        } else {
            if let Some(rules) = Rules::at_place(place, &[table]) {
                rules.make_room(table, &last.name);
            }
            // Removed first, so that the key has the position of the option.
            table.remove(last.name.as_str());
            table.insert(key, value);
        }
    } else if let Some(element) = step(node, last, New::Table, report) {
        *element = value;
    }
}

/// Handling of a name in a path that does not exist yet.
enum New<'a> {
    /// Add an empty table.
    Table,
    /// Report that no entry of this kind has the name.
    Refused(&'a str),
}

/// The child that a segment names.
fn step<'t>(
    node: &'t mut Node,
    segment: &Segment,
    new: New,
    report: &mut Report,
) -> Option<&'t mut Node> {
    let name = segment.name.as_str();
    match node.get_mut() {
        Content::Table(table) => {
            if let (false, New::Refused(kind)) = (table.contains_key(name), new) {
                let names: Vec<_> = table.keys().map(|k| k.get_ref().as_str()).collect();
                let message = format!("no {kind} is named {}", suggest::text(name));
                let help = match names.is_empty() {
                    true => format!("the scene has no `[{kind}.NAME]`"),
                    false => suggest::hint(name, &names, suggest::text, "the names are"),
                };
                report.error("dangling-name", &segment.at, message).help = Some(help);
                return None;
            }
            let key = Key::new(segment.at.clone(), name.to_owned());
            let empty = || Node::new(segment.at.clone(), Content::Table(Entries::new()));
            Some(table.entry(key).or_insert_with(empty))
        }
        Content::Array(items) => {
            let name_of = |item: &Node| {
                let name = item.get_ref().as_table()?.get("name")?;
                Some(name.get_ref().as_str()?.to_owned())
            };
            let names: Vec<_> = items.iter().map(name_of).collect();
            let named = names.iter().position(|n| n.as_deref() == Some(name));
            let index = named.or_else(|| name.parse().ok());
            let count = items.len();
            let entry = index.and_then(|i| items.get_mut(i));
            if entry.is_none() {
                let words: Vec<_> = names.iter().flatten().map(String::as_str).collect();
                let meant = suggest::nearest(name, words).map(suggest::text);
                let help = "write an index, counted from 0, or the `name` of an instance".into();
                let message = match index {
                    Some(i) => format!("there is no index {i} in a list of {count}"),
                    None => format!("nothing in the list is named {}", suggest::text(name)),
                };
                report.error("dangling-name", &segment.at, message).help =
                    Some(meant.map_or(help, |m| format!("did you mean {m}?")));
            }
            entry
        }
        _ => {
            let message = format!(
                "{} cannot be set: its parent is not a table",
                suggest::key(name)
            );
            report.error("bad-set", &segment.at, message);
            None
        }
    }
}
