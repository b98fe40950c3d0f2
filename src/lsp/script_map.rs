//! Completion inside of the maps `#{ … }` of scripts: keys that functions of `ctx` take, and keys of `setup`'s result.

use std::{cell::Cell, ops::Range, path::Path};

use serde_json::{Value, json};

use super::{
    answer::{KeyForm, PROPERTY, VALUE, item, keys},
    call::{code, is_word},
    names::kinds_of_value,
};
use reflet_scene::{
    diagnostic::TABLES,
    manual::{key_text, variant_text},
    parse::tables::Manual,
    script::api,
};

/// Longest script that is searched, bytes, most values that are followed, and how far each of them.
const MOST_BYTES: usize = 1 << 17;
const MOST_VALUES: usize = 60;
const DEPTH: usize = 6;

/// Functions that take the keys of a text shape.
const TEXTS: [&str; 2] = ["text_width", "text_letters"];

/// Bracket that is open at a place.
#[derive(Debug)]
struct Open {
    at: usize,
    kind: Kind,
    /// Byte range of the key whose value is being written, in a map.
    key: Option<Range<usize>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Map,
    List,
    Parenthesis,
    Block,
}

/// Where the value at a place goes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Goal {
    /// Function that takes it; `None` for the result of `setup`.
    function: Option<String>,
    /// Keys of the maps around it, from the outermost; for the keys of a text shape as in the result of `setup`.
    path: Vec<String>,
}

impl Goal {
    /// Whether it takes the keys of a text shape.
    fn is_text(&self) -> bool {
        self.function
            .as_deref()
            .is_some_and(|name| TEXTS.contains(&name))
    }
}

struct Script<'a> {
    text: &'a str,
    code: Vec<(usize, char)>,
    /// Number of values that may still be followed.
    left: Cell<usize>,
}

/// Completions inside of a map.
#[derive(Debug)]
pub enum Inside {
    /// All of them.
    Items(Vec<Value>),
    /// Names of these kinds, as the key of the value takes them.
    Names(&'static [&'static str]),
}

/// Completions at a byte offset in a map whose goal is known: keys, or in quotes the words and names of the key's
/// value.
pub fn complete(text: &str, offset: usize, quoted: bool, snippets: bool) -> Option<Inside> {
    if text.len() > MOST_BYTES {
        return None;
    }
    let script = Script {
        text,
        code: code(text),
        left: Cell::new(MOST_VALUES),
    };
    let start = match quoted {
        true => text[..offset].rfind('"')?,
        false => text[..offset].trim_end_matches(is_word).len(),
    };
    let open = script.open_at(start);
    if !quoted {
        let map = open.last().filter(|open| open.kind == Kind::Map)?;
        let at_key = map.key.is_none();
        let goal = script.goal(map.at, DEPTH).filter(|_| at_key)?;
        let form = KeyForm::at(text, offset, ": ", snippets);
        return Some(Inside::Items(script.keys(&goal, map.at, form)));
    }
    let map = open.iter().rfind(|open| open.kind != Kind::List)?;
    let key = text[map.key.clone()?].to_owned();
    let goal = script.goal(map.at, DEPTH)?;
    let words = words(&goal, &key);
    Some(match words.is_empty() {
        true => Inside::Names(kinds_of_value(&key)),
        false => Inside::Items(words),
    })
}

impl Script<'_> {
    /// Brackets that are open at a byte offset, outermost first.
    fn open_at(&self, offset: usize) -> Vec<Open> {
        let mut open: Vec<Open> = Vec::new();
        let mut last = ' ';
        for &(at, c) in self.code.iter().take_while(|(at, _)| *at < offset) {
            let kind = match c {
                '{' if last == '#' => Some(Kind::Map),
                '{' => Some(Kind::Block),
                '[' => Some(Kind::List),
                '(' => Some(Kind::Parenthesis),
                _ => None,
            };
            if let Some(kind) = kind {
                let key = None;
                open.push(Open { at, kind, key });
            }
            match c {
                '}' | ']' | ')' => drop(open.pop()),
                ':' => {
                    if let Some(map) = open.last_mut().filter(|open| open.kind == Kind::Map) {
                        let before = self.text[..at].trim_end();
                        let end = before.trim_end_matches('"').len();
                        let start = before[..end].trim_end_matches(is_word).len();
                        map.key = Some(start..end);
                    }
                }
                ',' => {
                    if let Some(map) = open.last_mut() {
                        map.key = None;
                    }
                }
                _ => {}
            }
            last = c;
        }
        open
    }

    /// Meaning of the value that begins at a byte offset, such as a map's brace.
    fn goal(&self, offset: usize, depth: usize) -> Option<Goal> {
        let depth = depth.checked_sub(1)?;
        self.left.set(self.left.get().checked_sub(1)?);
        let open = self.open_at(offset);
        match open.last() {
            Some(list) if list.kind == Kind::List => self.goal(list.at, depth),
            Some(map) if map.kind == Kind::Map => {
                let key = map.key.clone()?;
                let mut goal = self.goal(map.at, depth)?;
                goal.path.push(self.text[key].to_owned());
                Some(goal)
            }
            Some(call) if call.kind == Kind::Parenthesis => {
                let callee = self.text[..call.at].trim_end();
                let owner = callee.trim_end_matches(is_word);
                let name = &callee[owner.len()..];
                if TEXTS.contains(&name) {
                    let path = ["models", "", "shape"].map(str::to_owned).to_vec();
                    let function = Some(name.to_owned());
                    return Some(Goal { function, path });
                }
                let owner = owner.trim_end().strip_suffix('.')?.trim_end();
                let variable = &owner[owner.trim_end_matches(is_word).len()..];
                match (variable, name) {
                    ("ctx", _) => Some(Goal {
                        function: Some(name.to_owned()),
                        path: Vec::new(),
                    }),
                    (_, "push") => self.goal_of(variable, depth),
                    _ => None,
                }
            }
            _ => self.goal_of_statement(offset, depth),
        }
    }

    /// Where the value of the statement goes that a value at a byte offset ends: into a variable, or out of the
    /// function.
    fn goal_of_statement(&self, offset: usize, depth: usize) -> Option<Goal> {
        let before = self.text[..offset].trim_end_matches('#').trim_end();
        if let Some(left) = before.strip_suffix('=').filter(|l| !l.ends_with('=')) {
            let left = left.trim_end();
            return self.goal_of(&left[left.trim_end_matches(is_word).len()..], depth);
        }
        if !before.ends_with(['{', '}', ';']) && !before.ends_with("return") {
            return None;
        }
        let (_, function) = before.rsplit_once("fn ")?;
        match function.split('(').next().unwrap_or_default().trim() {
            "setup" => Some(Goal::default()),
            name => self.goal_of(name, depth),
        }
    }

    /// Where the value of a variable or function goes, by the first of its uses that tells it.
    fn goal_of(&self, name: &str, depth: usize) -> Option<Goal> {
        let is_own = |at: &usize| {
            let (before, after) = (&self.text[..*at], &self.text[at + name.len()..]);
            let ends = !before.ends_with(is_word) && !after.starts_with(is_word);
            // Neither where it is defined nor where it is changed.
            let follows = after.trim_start();
            let is_changed = follows.starts_with(['.', '[']) || follows.starts_with('=');
            let is_defined = before.ends_with("fn ") || before.ends_with("let ");
            ends && !is_changed && !is_defined
        };
        let places = self.text.match_indices(name).map(|(at, _)| at);
        let mut uses = places.filter(is_own);
        (!name.is_empty()).then_some(())?;
        uses.find_map(|at| self.goal(at, depth))
    }

    /// Keys that a map of this goal may still get.
    fn keys(&self, goal: &Goal, map: usize, form: KeyForm) -> Vec<Value> {
        let own = self.entries(map);
        let has = |item: &Value| own.iter().any(|(key, _)| item["label"] == *key);
        let mut all = match &goal.function {
            Some(name) if goal.path.is_empty() => function_keys(name),
            Some(_) if !goal.is_text() => Vec::new(),
            None if goal.path.is_empty() => {
                let names = TABLES.iter().map(|table| table.0).chain(["environment"]);
                names
                    .map(|name| json!({ "label": name, "kind": PROPERTY }))
                    .collect()
            }
            _ => {
                let section = Manual::for_file(Path::new("")).table(&table(&goal.path));
                section.map_or_else(Vec::new, |section| {
                    let chosen = section.variants.first().map(|variant| variant.key);
                    let kind = own.iter().find(|(key, _)| Some(*key) == chosen);
                    let word = kind.map(|(_, word)| *word);
                    let word = word.or_else(|| goal.is_text().then_some("text"));
                    let known = section.variants.iter().find(|v| Some(v.word) == word);
                    keys(section, known.map(|variant| variant.word), form, &|_| false)
                })
            }
        };
        // The function has the text, and knows its kind.
        let is_given =
            |item: &Value| goal.is_text() && (item["label"] == "kind" || item["label"] == "text");
        all.retain(|item| !has(item) && !is_given(item));
        all
    }

    /// Keys of the map whose brace is at a byte offset, each with the text that its value begins with, without quotes.
    fn entries(&self, map: usize) -> Vec<(&str, &str)> {
        let mut entries = Vec::new();
        let mut depth = 0;
        for &(at, c) in self.code.iter().skip_while(|(at, _)| *at < map) {
            match c {
                '{' | '[' | '(' => depth += 1,
                '}' | ']' | ')' => depth -= 1,
                ':' if depth == 1 => {
                    let before = self.text[..at].trim_end().trim_end_matches('"');
                    let key = &before[before.trim_end_matches(is_word).len()..];
                    let after = self.text[at + 1..].trim_start().trim_start_matches('"');
                    let end = after.find(|c| !is_word(c)).unwrap_or(after.len());
                    entries.push((key, &after[..end]));
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
        entries
    }
}

/// Keys of the map that a function of `ctx` takes, with the manual's text of the table that they are of.
fn function_keys(name: &str) -> Vec<Value> {
    let table = match name {
        "instance_material" => "material",
        name => name,
    };
    let manual = Manual::for_file(Path::new(""));
    let path = [table.to_owned(), String::new()];
    let text = |key: &str| {
        let known = manual.key(&path, key);
        known.map_or_else(String::new, |(section, kind, key)| {
            key_text(section, kind, key)
        })
    };
    let keys = api::map_keys(name).into_iter();
    keys.map(|key| item(key, PROPERTY, &text(key))).collect()
}

/// Words that the value of a key may be.
fn words(goal: &Goal, key: &str) -> Vec<Value> {
    if goal.function.is_some() && !goal.is_text() || goal.path.is_empty() {
        return Vec::new();
    }
    let (manual, path) = (Manual::for_file(Path::new("")), table(&goal.path));
    let mut all = Vec::new();
    if let Some((section, kind, record)) = manual.key(&path, key) {
        let text = key_text(section, kind, record);
        let words = record.words.iter().map(|word| word.name);
        all.extend(words.map(|word| item(word, VALUE, &text)));
    }
    if let Some(section) = manual.table(&path) {
        let chosen = section.variants.iter().filter(|v| v.key == key);
        all.extend(chosen.map(|v| item(v.word, VALUE, &variant_text(section, v.word))));
    }
    all
}

/// Path in scene text of a path in the result of `setup`.
fn table(path: &[String]) -> Vec<String> {
    let mut path = path.to_vec();
    if let Some(known) = TABLES.iter().find(|(returned, ..)| path[0] == *returned) {
        known.1.clone_into(&mut path[0]);
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels at `|`.
    fn labels(text: &str) -> Vec<String> {
        let (before, after) = text.split_once('|').expect("a mark");
        let quoted = super::super::call::in_quotes(before);
        match complete(&format!("{before}{after}"), before.len(), quoted, false) {
            Some(Inside::Items(all)) => {
                let label = |item: &Value| item["label"].as_str().unwrap_or_default().to_owned();
                all.iter().map(label).collect()
            }
            Some(Inside::Names(kinds)) => kinds.iter().map(|kind| format!("<{kind}>")).collect(),
            None => Vec::new(),
        }
    }

    fn check(text: &str, wanted: &str, others: &str) {
        let found = labels(text);
        let is_found = |word: &str| found.iter().any(|label| label == word);
        assert!(wanted.split_whitespace().all(is_found), "{text}: {found:?}");
        assert!(
            !others.split_whitespace().any(is_found),
            "{text}: {found:?}"
        );
    }

    /// Lines of `maps.txt`: a script with its cursor, words that are proposed there, and words that are not.
    #[test]
    fn maps_have_the_keys_that_they_take_wherever_they_go() {
        for case in include_str!("tests/maps.txt").lines() {
            let (text, words) = case.split_once(" => ").expect("words");
            let (wanted, others) = words.split_once(';').expect("two lists");
            check(&text.replace("\\n", "\n"), wanted, others);
        }
        // Values that go in a circle are followed a limited number of times.
        let circle = "a = b; b = c; c = a;\n".repeat(1000);
        let text = format!("fn f(a, b, c) {{ {circle} a = #{{ | }}; }}");
        check(&text, "", "model");
    }
}
