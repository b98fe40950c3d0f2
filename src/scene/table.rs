//! The cursor from which readers take keys. It remembers every key that was asked for, so that any other
//! key is an error; when run for the manual, it records each key instead.

pub mod color;
mod enum_values;
pub mod key_recorder;
pub mod located;
mod nested;
pub mod params;
pub mod points;
pub mod report;
mod rules;
pub mod value;
pub mod value_advice;
mod variants;

use std::ops::Range as Bytes;

use self::{
    key_recorder::{KeyRecord, RecordedKeys, SectionRecord, accepts},
    located::{At, Written},
    report::Report,
    value::{Named, Names, Value},
};
use crate::declared::{Described, TypeDoc};
use crate::diagnostic::{Diagnostic, Source, Span};
use crate::syntax::{self, Entries, Node};
use crate::{forms, range::Range, suggest};

pub use self::nested::{Either, NumberOr, ValueOr};

/// A description that is written as a table.
pub trait Section: Described + Sized {
    /// Comments of further types whose fields are keys of the same table.
    const ALSO: &'static [&'static TypeDoc] = &[];
    /// How the table is written, such as `[camera.NAME]`.
    const HEADING: &'static str;
    /// Reads every key; mistakes go to the report.
    fn read(table: &mut Table) -> Option<Self>;
    /// Advice for a `key` whose value is not a table.
    fn instead(_key: &str, _value: &Node) -> Option<String> {
        None
    }
}

/// A description with a reader of its keys, made of its declaration.
pub trait Keys: Sized {
    /// Reads every key; mistakes go to the report.
    fn read_keys(t: &mut Table) -> Option<Self>;
}

/// Type of a key without a default: an `Option` may be left out, and a list of names; any other value must be there.
pub trait Key: Sized {
    /// Reads the key; `None` where it must be there and is missing, or is wrong.
    fn read(t: &mut Table, key: &'static str, range: Range) -> Option<Self>;
}

impl<V: Value> Key for V {
    fn read(t: &mut Table, key: &'static str, range: Range) -> Option<Self> {
        t.need(key, range)
    }
}

impl<V: Value> Key for Option<V> {
    fn read(t: &mut Table, key: &'static str, range: Range) -> Option<Self> {
        Some(t.find(key, range))
    }
}

impl Key for Vec<At<String>> {
    fn read(t: &mut Table, key: &'static str, range: Range) -> Option<Self> {
        Some(
            t.find(key, range)
                .map_or_else(Vec::new, |Names(names)| names),
        )
    }
}

/// Reads a key by a function.
pub fn read_by<T>(t: &mut Table, read: impl FnOnce(&mut Table) -> Option<T>) -> Option<T> {
    read(t)
}

/// Reads no key: another table sets the field.
pub fn apart<T: Default>(_: &mut Table) -> Option<T> {
    Some(T::default())
}

/// Declares by a function, before the keys of a table, rules that they follow, or keys that no field has.
pub fn before(t: &mut Table, declare: fn(&mut Table)) {
    declare(t);
}

/// Checks a description by a function.
pub fn check<T>(t: &mut Table, it: &T, check: fn(&T, &mut Table)) {
    check(it, t);
}

/// Changes a description by a function.
pub fn then<T>(t: &mut Table, it: T, change: fn(T, &mut Table) -> T) -> T {
    change(it, t)
}

/// Advice by a function for a `key` whose value is not a table.
pub fn instead(
    key: &str,
    value: &Node,
    advise: fn(&str, &Node) -> Option<String>,
) -> Option<String> {
    advise(key, value)
}

/// Location of a table.
#[derive(Clone, Default)]
pub struct Place {
    /// Its path, such as `camera.main`; empty for the whole file.
    pub path: String,
    /// Whether it is one of an array of tables.
    pub in_list: bool,
    /// Byte range of its header or its braces.
    pub at: Bytes<usize>,
    /// The whole file in messages; empty for a scene.
    pub whole: &'static str,
    /// Tables of the whole file as their readers declare them, for advice about keys of another table.
    pub all: Option<fn() -> &'static [SectionRecord]>,
}

impl Place {
    /// Name of the table in messages, such as `[camera.main]`.
    fn title(&self) -> String {
        match (self.path.as_str(), self.in_list) {
            ("", _) if self.whole.is_empty() => "the scene".into(),
            ("", _) => self.whole.into(),
            (path, true) => format!("`[[{}]]`", suggest::clip(path)),
            (path, false) => format!("`[{}]`", suggest::clip(path)),
        }
    }

    fn nested(&self, key: &str, at: Bytes<usize>) -> Self {
        let dot = if self.path.is_empty() { "" } else { "." };
        Self {
            path: format!("{}{dot}{key}", self.path),
            in_list: false,
            at,
            ..self.clone()
        }
    }
}

/// A required key that a table lacks, or one of several.
struct Missing {
    keys: Vec<&'static str>,
    message: String,
    help: String,
}

/// A value that a key may have in a table at a place, as scene text has it.
fn example<V: Value>(place: &Place, key: &str, range: Range) -> &'static str {
    let is_right = |text: &&String| {
        let source = Source::new("", format!("x = {text}"));
        let node = source.syntax().root().get("x");
        let named = Named { key, range: &range };
        node.is_some_and(|node| V::read(node, &named, &mut Report::default()).is_some())
    };
    let table = place.path.rsplit('.').next().unwrap_or_default();
    let own = suggest::examples(&format!("{table}.{key}")).iter();
    let listed = own.chain(suggest::examples(key)).find(is_right);
    listed.map_or("…", String::as_str)
}

/// One table of the tree, being read.
pub struct Table<'r> {
    /// Report that messages go to.
    pub report: &'r mut Report,
    values: &'r Entries,
    place: Place,
    asked: Vec<&'static str>,
    /// Missing required keys, each with advice; reported at the end, unless an unknown key is probably
    /// a misspelling of one.
    missing: Vec<Missing>,
    errors_before: usize,
    notes: Option<&'r mut RecordedKeys>,
}

impl<'r> Table<'r> {
    /// Reads `values` as a `T`; every key that `T` did not ask for is an error.
    pub fn read<T: Section>(
        report: &'r mut Report,
        values: &'r Entries,
        place: Place,
    ) -> Option<T> {
        Table::read_by(report, values, place, T::read)
    }

    /// Reads `values` by a function; every key that it did not ask for is an error.
    fn read_by<T>(
        report: &'r mut Report,
        values: &'r Entries,
        place: Place,
        read: impl FnOnce(&mut Table) -> Option<T>,
    ) -> Option<T> {
        let mut table = Table::new(report, values, place, None);
        let value = read(&mut table);
        table.refuse_unknown();
        table.refuse_missing();
        value
    }

    /// Runs `T`'s reader on an empty table, to record the keys that it reads.
    pub fn describe<T: Section>(notes: &mut RecordedKeys) {
        if notes.open(T::DOC, T::ALSO, T::HEADING) {
            let (mut report, nothing) = (Report::default(), Entries::new());
            T::read(&mut Table::new(
                &mut report,
                &nothing,
                Place::default(),
                Some(notes),
            ));
            notes.close();
        }
    }

    fn new(
        report: &'r mut Report,
        values: &'r Entries,
        place: Place,
        notes: Option<&'r mut RecordedKeys>,
    ) -> Self {
        let errors_before = report.errors();
        let (asked, missing) = (Vec::new(), Vec::new());
        Self {
            report,
            values,
            place,
            asked,
            missing,
            errors_before,
            notes,
        }
    }

    /// Path of the table in the scene, such as `model.ball`.
    pub fn path(&self) -> &str {
        &self.place.path
    }

    fn note(&mut self, key: &'static str, note: impl FnOnce() -> KeyRecord) {
        self.asked.push(key);
        if let Some(notes) = &mut self.notes {
            notes.add(note());
        }
    }

    /// Whether the key is written.
    pub fn has(&self, key: &str) -> bool {
        self.values.contains_key(key)
    }

    /// Whether everything so far was right, so that comparing values makes sense; false when the
    /// reader runs only to be described.
    pub fn clean(&self) -> bool {
        let unbroken = self.report.errors() == self.errors_before;
        self.notes.is_none() && unbroken && self.missing.is_empty()
    }

    /// Place where the table starts.
    pub fn start(&self) -> Span {
        self.report.span(&self.place.at)
    }

    /// Place of a key's value, else of the table, for messages of later stages.
    pub fn written(&self, key: &str) -> Written {
        Written(self.report.span(&self.value_at(key)))
    }

    /// Whether the text of the table begins with these signs.
    fn begins_with(&self, signs: &str) -> bool {
        let at = self.start();
        let written = at
            .source
            .as_ref()
            .and_then(|s| s.text.get(at.range.start..));
        written.is_some_and(|text| text.starts_with(signs))
    }

    /// Range of a key's value, else of the table.
    fn value_at(&self, key: &str) -> Bytes<usize> {
        self.values
            .get(key)
            .map_or(self.place.at.clone(), |node| node.span())
    }

    fn key_at(&self, key: &str) -> Bytes<usize> {
        self.values
            .get_key_value(key)
            .map_or(self.place.at.clone(), |(k, _)| k.span())
    }

    /// The value of an optional key.
    pub fn find<V: Value>(&mut self, key: &'static str, range: Range) -> Option<V> {
        self.note(key, || KeyRecord::value::<V>(key, range));
        self.plain(key, range)
    }

    /// The value of a key with a default.
    pub fn get<V: Value>(&mut self, key: &'static str, range: Range, default: V) -> V {
        self.note(key, || {
            KeyRecord::value::<V>(key, range).default(default.to_json())
        });
        self.plain(key, range).unwrap_or(default)
    }

    /// The value of a key that must be there.
    pub fn need<V: Value>(&mut self, key: &'static str, range: Range) -> Option<V> {
        self.note(key, || KeyRecord::value::<V>(key, range).required());
        if !self.has(key) {
            let range_of = range;
            let range = if V::RANGED {
                range.words()
            } else {
                String::new()
            };
            let comma = if range.is_empty() { "" } else { ", " };
            let help = match V::WORDS {
                [first, ..] => format!(
                    "write `{key} = \"{}\"`, or another of {}",
                    first.name,
                    V::expected()
                ),
                [] => format!(
                    "write `{key} = {}`, {}{comma}{range}",
                    example::<V>(&self.place, key, range_of),
                    V::expected()
                ),
            };
            let help = V::example().map_or(help, |e| format!("write `{key} = {e}`"));
            self.missing.push(self.missing_key(key, help));
        }
        self.plain(key, range)
    }

    fn missing_key(&self, key: &'static str, help: String) -> Missing {
        Missing {
            keys: vec![key],
            message: format!("`{key}` is missing in {}", self.place.title()),
            help,
        }
    }

    fn plain<V: Value>(&mut self, key: &str, range: Range) -> Option<V> {
        let node = self.values.get(key)?;
        let value = V::read(node, &Named { key, range: &range }, self.report);
        if value.is_some() || !self.report.lacks_advice() {
            return value;
        }
        let example = example::<V>(&self.place, key, range);
        if example != "…" {
            self.report.advise(match V::WORDS {
                [] => format!("write {}, such as {example}", V::expected()),
                _ => format!("write {example}, or another of these words"),
            });
        }
        value
    }

    fn unknown(&self) -> Vec<(&'r syntax::Key, &'r Node)> {
        let asked = |key: &str| self.asked.contains(&key);
        self.values
            .iter()
            .filter(|(key, _)| !asked(key.get_ref()))
            .collect()
    }

    fn refuse_unknown(&mut self) {
        for (key, node) in self.unknown() {
            let name = key.get_ref().as_str();
            if self.report.is_full() {
                self.report.error("unknown-key", &key.span(), "");
                continue; // only counted
            }
            let message = format!(
                "{} is not a key of {}",
                suggest::key(name),
                self.place.title()
            );
            let meant = suggest::nearest(name, self.asked.iter().copied());
            let kind = self.values.get("kind").and_then(|k| k.get_ref().as_str());
            let absent = kind.and_then(|kind| suggest::absent_of_kind(kind, name));
            let absent = absent.or_else(|| suggest::absent_key(name, &self.asked));
            let advised = absent.and_then(suggest::key_of_advice);
            let is_meant = |key: &str| Some(key) == meant || Some(key) == advised;
            self.missing
                .retain(|missing| !missing.keys.iter().any(|key| is_meant(key)));
            let help = (absent.map(|help| self.filled(help, name)))
                .or_else(|| {
                    self.key_of_the_file(name)
                        .filter(|_| !self.begins_with("{"))
                })
                .or_else(|| self.key_of_another(name).filter(|_| meant.is_none()))
                .or_else(|| {
                    let path = format!("{} {name}", self.place.path);
                    forms::explained("motion", &path).map(|(_, help)| help)
                })
                .or_else(|| {
                    let is_header = node.get_ref().as_table().is_some()
                        && self.place.path.matches('.').count() == 1;
                    let (kind, first) = self.place.path.split_once('.').filter(|_| is_header)?;
                    let path = format!("[{kind}.{}]", suggest::text(&format!("{first}.{name}")));
                    meant.is_none().then(|| {
                        format!(
                            "a name with a point stands in quotes: write `{path}` if one is meant"
                        )
                    })
                })
                .unwrap_or_else(|| suggest::hint(name, &self.asked, suggest::key, "its keys are"));
            self.report.error("unknown-key", &key.span(), message).help = Some(help);
        }
    }

    /// An advice about a key with values of this table.
    fn filled(&self, help: &str, key: &str) -> String {
        let value_of = |key: &str| {
            let span = self.report.span(&self.values.get(key)?.span());
            Some(span.source?.text.get(span.range)?.to_owned())
        };
        // The section that has all keys of this table.
        let has = |section: &&SectionRecord, key: &str| {
            section.all_keys().any(|it| it.name == key)
                || section.variants.iter().any(|it| it.key == key)
        };
        let all = self.place.all.map_or(&[][..], |all| all());
        let own = (all.iter()).find(|it| self.asked.iter().all(|key| has(it, key)));
        let fits = |key: &str, value: &str| {
            let records = own.into_iter().flat_map(SectionRecord::all_keys);
            let mut records = records.filter(|it| it.name == key).peekable();
            // Numbers up to π are radians elsewhere, but for the width of the sun.
            let is_radians = key.ends_with("_deg")
                && key != "angle_deg"
                && value.parse().is_ok_and(|x: f64| x != 0.0 && x.abs() < 3.2);
            let is_taken = |record: &KeyRecord| accepts(record, value, all);
            !is_radians && (records.peek().is_none() || records.any(is_taken))
        };
        suggest::filled(help, key, value_of, fits)
    }

    /// Help for a key of the whole file that stands below the header of this table.
    fn key_of_the_file(&self, name: &str) -> Option<String> {
        let file = self.place.all?();
        let is_key = file.first()?.keys.iter().any(|k| k.name == name);
        (is_key && !self.place.path.is_empty()).then(|| {
            format!(
                "{} belongs to the whole file, but TOML gives each line below a header to that table: move this line \
                 above the first header, or begin a table of its own",
                suggest::key(name)
            )
        })
    }

    /// Help for a key of one or two other kinds of tables that have headers.
    fn key_of_another(&self, name: &str) -> Option<String> {
        let has = |s: &&SectionRecord| {
            s.heading.starts_with('[') && s.keys.iter().any(|k| k.name == name)
        };
        if self.begins_with("{") && self.place.path.matches('.').count() > 1 {
            return None; // a part of another table
        }
        let tables: Vec<_> = self.place.all?().iter().filter(has).collect();
        let titles: Vec<_> = tables.iter().map(|s| suggest::key(s.heading)).collect();
        (1..3).contains(&titles.len()).then(|| {
            format!(
                "it is a key of {}: write it below that header",
                titles.join(" and of ")
            )
        })
    }

    fn refuse_missing(&mut self) {
        let missing = std::mem::take(&mut self.missing);
        if missing.is_empty() {
            return;
        }
        let name = self.values.get("name").and_then(|n| n.get_ref().as_str());
        let path = match name.filter(|_| self.place.in_list) {
            Some(name) => format!("{}.{name}", self.place.path),
            None => self.place.path.clone(),
        };
        let removed = self.report.removed(&path);
        let removed = removed.map(|at| {
            (
                at,
                "the table that this one changes is removed here".to_owned(),
            )
        });
        let title = self.place.title();
        if let Some((first, second)) = self.report.disputed(&path) {
            let [first, second] = [first, second].map(suggest::text);
            let message = format!(
                "variant {first} removes {}, of which variant {second} changes keys",
                suggest::key(&path)
            );
            let error = (self.report).error("variants-disagree", &self.place.at, message);
            error.help = Some(format!(
                "choose one of the two, choose {second} before {first}, or write all of {title} in {second}"
            ));
            error.related = removed;
            return;
        }
        let named_at = self.values.get("name").map(Node::span);
        let near = named_at.and_then(|at| self.report.advice_at("near-name", &at));
        let near = near.map(str::to_owned);
        let of_layer = name.filter(|_| self.place.in_list && self.begins_with("[[variant."));
        for Missing { message, help, .. } in missing {
            let error = (self.report).error("missing-key", &self.place.at, message);
            error.help = Some(match of_layer {
                _ if near.is_some() => near.clone().unwrap_or_default(),
                Some(name) => format!(
                    "{help}; or give it the name of the one that it changes: none is named {}",
                    suggest::text(name)
                ),
                None => help,
            });
            error.related.clone_from(&removed);
        }
    }

    /// Gives a key that no field stands for its comment in the manual.
    pub fn explain(&mut self, key: &str, text: impl FnOnce() -> String) {
        if let Some(notes) = &mut self.notes {
            notes.change(key, |key| key.text = Some(text()));
        }
    }

    /// Says of which kinds the entries are that the text of a key names.
    pub fn refers(&mut self, key: &str, kinds: &'static [&'static str]) {
        if let Some(notes) = &mut self.notes {
            notes.change(key, |key| key.entries = kinds);
        }
    }

    /// Says which extensions the files have that the text of a key names.
    pub fn files(&mut self, key: &str, extensions: &'static [&'static str]) {
        if let Some(notes) = &mut self.notes {
            notes.change(key, |key| key.files = extensions);
        }
    }

    /// Reports a mistake at a byte of the text of a key, whose quotes are one byte each side.
    pub fn refuse_byte(&mut self, name: &'static str, key: &str, byte: usize, say: (&str, &str)) {
        let mut at = self.value_at(key);
        // Text with escapes or in triple quotes is longer than its value.
        let text = self
            .values
            .get(key)
            .and_then(|node| node.get_ref().as_str());
        if text.is_some_and(|text| text.len() + 2 == at.len() && byte <= text.len()) {
            let start = at.start + 1 + byte;
            at = start..start + 1;
        }
        self.report.error(name, &at, say.0).help = Some(say.1.to_owned());
    }

    /// Reports a mistake in the value of a key.
    pub fn refuse(&mut self, name: &'static str, key: &str, message: &str, help: &str) {
        let at = self.value_at(key);
        let error = self.report.error(name, &at, message);
        error.help = (!help.is_empty()).then(|| help.to_owned());
    }

    /// Warns of the value of a key.
    pub fn warn(&mut self, name: &'static str, key: &str, message: &str, help: &str) {
        let at = self.report.span(&self.value_at(key));
        self.report
            .push(Diagnostic::new(name, at, message).help(help).warning());
    }

    /// Refuses a value that is a table, as [`Table::refuse`] does; returns whether it is one.
    pub fn refuse_table(
        &mut self,
        name: &'static str,
        key: &'static str,
        message: &str,
        help: &str,
    ) -> bool {
        let node = self.values.get(key);
        let is_table = node.is_some_and(|node| node.get_ref().as_table().is_some());
        if is_table {
            self.asked.push(key);
            self.refuse(name, key, message, help);
        }
        is_table
    }
}
