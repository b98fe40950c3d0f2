//! The cursor that readers pull keys from. It remembers every key that was asked for, so that what
//! was not asked for is an error, and, when run for the manual, describes each key instead.

use std::ops::Range as Bytes;

use toml::de::{DeTable, DeValue};


use super::{
    notes::{Form, KeyNote, Notes, Rule},
    report::Report,
    suggest,
    value::{Named, Node, Range, Value, found, one_of, word, wrong_type},
};
use crate::scene::{
    desc::Entry,
    diagnostic::Span,
};

/// A description that is written as a table.
pub trait Section: Sized {
    /// Name of its type in `desc.rs`, where its manual stands.
    const TYPE: &'static str;
    /// Further types of `desc.rs` whose fields are keys of the same table.
    const ALSO: &'static [&'static str] = &[];
    /// How the table is written, such as `[camera.NAME]`.
    const HEADING: &'static str;
    /// Pulls every key; what is wrong goes to the report.
    fn read(table: &mut Table) -> Option<Self>;
}

/// Reader of one variant of a table with a `kind`.
pub type Variant<T> = (&'static str, fn(&mut Table) -> Option<T>);

/// A plain value, or a table in its place.
pub enum Either<V, T> {
    /// The value.
    Plain(V),
    /// What the table says.
    Nested(T),
}

/// One table of the tree, being read.
pub struct Table<'r, 'i> {
    /// Where messages go.
    pub report: &'r mut Report,
    values: &'r DeTable<'i>,
    /// How messages call the table, such as `[camera.main]`.
    title: String,
    at: Bytes<usize>,
    asked: Vec<&'static str>,
    errors_before: usize,
    notes: Option<&'r mut Notes>,
}

impl<'r, 'i> Table<'r, 'i> {
    /// Reads `values` as a `T`; every key that `T` did not ask for is an error.
    pub fn read<T: Section>(
        report: &'r mut Report,
        values: &'r DeTable<'i>,
        title: &str,
        at: Bytes<usize>,
    ) -> Option<T> {
        let mut table = Table::new(report, values, title, at, None);
        let value = T::read(&mut table);
        table.refuse_unknown();
        value
    }

    /// Runs `T`'s reader on nothing, to write down what it asks for.
    pub fn describe<T: Section>(notes: &mut Notes) {
        if notes.open(T::TYPE, T::ALSO, T::HEADING) {
            let (mut report, nothing) = (Report::default(), DeTable::new());
            T::read(&mut Table::new(&mut report, &nothing, "", 0..0, Some(notes)));
            notes.close();
        }
    }

    fn new(
        report: &'r mut Report,
        values: &'r DeTable<'i>,
        title: &str,
        at: Bytes<usize>,
        notes: Option<&'r mut Notes>,
    ) -> Self {
        let errors_before = report.errors();
        let title = title.to_owned();
        Self { report, values, title, at, asked: Vec::new(), errors_before, notes }
    }

    fn note(&mut self, key: &'static str, note: impl FnOnce() -> KeyNote) {
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
        self.notes.is_none() && self.report.errors() == self.errors_before
    }

    /// Where the table starts.
    pub fn start(&self) -> Span {
        self.report.span(&self.at)
    }

    /// Range of a key's value, else of the table.
    pub fn place(&self, key: &str) -> Bytes<usize> {
        self.values.get(key).map_or(self.at.clone(), |node| node.span())
    }

    fn key_place(&self, key: &str) -> Bytes<usize> {
        self.values.get_key_value(key).map_or(self.at.clone(), |(k, _)| k.span())
    }

    /// The value of an optional key.
    pub fn find<V: Value>(&mut self, key: &'static str, range: Range) -> Option<V> {
        self.note(key, || KeyNote::value::<V>(key, range));
        self.plain(key, range)
    }

    /// The value of a key with a default.
    pub fn get<V: Value>(&mut self, key: &'static str, range: Range, default: V) -> V {
        self.note(key, || KeyNote::value::<V>(key, range).default(default.to_json()));
        self.plain(key, range).unwrap_or(default)
    }

    /// The value of a key that must be there.
    pub fn need<V: Value>(&mut self, key: &'static str, range: Range) -> Option<V> {
        self.note(key, || KeyNote::value::<V>(key, range).required());
        if !self.has(key) {
            self.missing(key, &V::expected());
        }
        self.plain(key, range)
    }

    fn plain<V: Value>(&mut self, key: &str, range: Range) -> Option<V> {
        let node = self.values.get(key)?;
        V::read(node, &Named { key, range: &range }, self.report)
    }

    fn missing(&mut self, key: &str, expected: &str) {
        let message = format!("`{key}` is missing in `{}`", self.title);
        let error = self.report.error("missing-key", &self.at, message);
        error.help = Some(format!("write `{key} = …`, {expected}"));
    }

    /// A table right of `key =`, or `[….key]`.
    pub fn table<T: Section>(&mut self, key: &'static str) -> Option<T> {
        self.note(key, || KeyNote::new(key, Form::Table(T::TYPE)));
        self.describe_nested::<T>();
        let node = self.values.get(key)?;
        self.nested(key, node)
    }

    /// A value or a table under the same key.
    pub fn find_or_table<V: Value, T: Section>(
        &mut self,
        key: &'static str,
        range: Range,
    ) -> Option<Either<V, T>> {
        self.note(key, || KeyNote::value::<V>(key, range).or(Form::Table(T::TYPE)));
        self.describe_nested::<T>();
        let node = self.values.get(key)?;
        match node.get_ref() {
            DeValue::Table(_) => self.nested(key, node).map(Either::Nested),
            _ => self.plain(key, range).map(Either::Plain),
        }
    }

    /// A value or tables `[….key.NAME]` under the same key.
    pub fn find_or_entries<V: Value, T: Section>(
        &mut self,
        key: &'static str,
        range: Range,
    ) -> Option<Either<V, Vec<Entry<T>>>> {
        self.note(key, || KeyNote::value::<V>(key, range).or(Form::Entries(T::TYPE)));
        self.describe_nested::<T>();
        let node = self.values.get(key)?;
        match node.get_ref() {
            DeValue::Table(_) => Some(Either::Nested(self.nested_entries(key, node))),
            _ => self.plain(key, range).map(Either::Plain),
        }
    }

    /// All tables `[key.NAME]`, in the order of the file.
    pub fn entries<T: Section>(&mut self, key: &'static str) -> Vec<Entry<T>> {
        self.note(key, || KeyNote::new(key, Form::Entries(T::TYPE)));
        self.describe_nested::<T>();
        let node = self.values.get(key);
        node.map_or_else(Vec::new, |node| self.nested_entries(key, node))
    }

    /// All tables `[[key]]`.
    pub fn list<T: Section>(&mut self, key: &'static str) -> Vec<T> {
        self.note(key, || KeyNote::new(key, Form::List(T::TYPE)));
        self.describe_nested::<T>();
        let Some(node) = self.values.get(key) else {
            return Vec::new();
        };
        let Some(items) = node.get_ref().as_array() else {
            let message = format!("`{key}` must be a list of tables, not {}", found(node));
            let error = self.report.error("wrong-type", &self.key_place(key), message);
            error.help = Some(format!("write `[[{key}]]`, with two brackets on each side"));
            return Vec::new();
        };
        let title = format!("[[{key}]]");
        let read = |item: &Node| match item.get_ref() {
            DeValue::Table(values) => Table::read(self.report, values, &title, item.span()),
            _ => {
                wrong_type(item, key, "a list of tables", self.report);
                None
            }
        };
        items.iter().filter_map(read).collect()
    }

    fn describe_nested<T: Section>(&mut self) {
        if let Some(notes) = &mut self.notes {
            Table::describe::<T>(notes);
        }
    }

    fn nested<T: Section>(&mut self, key: &str, node: &Node) -> Option<T> {
        let DeValue::Table(values) = node.get_ref() else {
            wrong_type(node, key, "a table", self.report);
            return None;
        };
        let title = self.nested_title(key);
        Table::read(self.report, values, &title, node.span())
    }

    fn nested_title(&self, key: &str) -> String {
        match self.title.strip_prefix('[').and_then(|t| t.strip_suffix(']')) {
            Some(path) if !path.starts_with('[') => format!("[{path}.{key}]"),
            Some(_) => format!("{key} of {}", self.title),
            None if self.title.contains(' ') => format!("{key} of {}", self.title),
            None => format!("[{key}]"),
        }
    }

    fn nested_entries<T: Section>(&mut self, key: &str, node: &Node) -> Vec<Entry<T>> {
        let example = self.nested_title(&format!("{key}.NAME"));
        let DeValue::Table(entries) = node.get_ref() else {
            let message = format!("`{key}` must be tables with names, not {}", found(node));
            let error = self.report.error("wrong-type", &self.key_place(key), message);
            error.help = Some(format!("write `{example}`, with a name of your choice"));
            return Vec::new();
        };
        let mut all: Vec<_> = entries.iter().collect();
        all.sort_by_key(|(name, _)| name.span().start);
        let mut read = Vec::new();
        let mut nameless = false;
        for (name, node) in all {
            let DeValue::Table(values) = node.get_ref() else {
                if !nameless {
                    let name = suggest::key(name.get_ref());
                    let message = format!("{name} must be a table in `{}`", self.nested_title(key));
                    let error = self.report.error("wrong-type", &node.span(), message);
                    error.help = Some(format!("write `{example}`, with a name of your choice"));
                }
                nameless = true; // the next keys of a table without its name are the same mistake
                continue;
            };
            let title = self.nested_title(&format!("{key}.{}", name.get_ref()));
            if let Some(value) = Table::read(self.report, values, &title, node.span()) {
                let at = self.report.span(&name.span());
                read.push(Entry { name: name.get_ref().to_string(), at, value });
            }
        }
        read
    }

    /// The variant that `key` names, read by its own reader. Ask for the common keys first: what is
    /// unknown after this is looked for in the other variants.
    pub fn choose<T>(&mut self, key: &'static str, variants: &[Variant<T>]) -> Option<T> {
        self.asked.push(key);
        if let Some(notes) = &mut self.notes {
            for (word, read) in variants {
                notes.open_variant(key, word);
                let (mut report, nothing) = (Report::default(), DeTable::new());
                read(&mut Table::new(&mut report, &nothing, "", 0..0, Some(notes)));
            }
            notes.close_variants();
            return None;
        }
        let words: Vec<_> = variants.iter().map(|v| v.0).collect();
        let chosen = match self.values.get(key) {
            Some(node) => word(node, key, &words, self.report),
            None => {
                self.missing(key, &one_of(&words));
                None
            }
        };
        let Some(chosen) = chosen else {
            // Without the kind nobody can say which keys are wrong.
            self.asked.extend(variants.iter().flat_map(|v| keys_of(v.1)));
            return None;
        };
        let read = variants.iter().find(|v| v.0 == chosen)?.1;
        let value = read(self);
        self.refuse_keys_of_other_kinds(key, chosen, variants);
        value
    }

    fn refuse_keys_of_other_kinds<T>(&mut self, kind: &str, chosen: &str, all: &[Variant<T>]) {
        for (key, _) in self.unknown() {
            let name = key.get_ref().as_ref();
            let others = all.iter().filter(|v| keys_of(v.1).contains(&name));
            let others: Vec<_> = others.map(|v| v.0).collect();
            let mine = all.iter().filter(|v| v.0 == chosen).flat_map(|v| keys_of(v.1));
            let mine: Vec<_> = mine.collect();
            let Some(known) = all.iter().flat_map(|v| keys_of(v.1)).find(|k| *k == name) else {
                continue;
            };
            self.asked.push(known);
            let chosen = suggest::text(chosen);
            let message = format!("`{name}` does not go with `{kind} = {chosen}`");
            let error = self.report.error("unknown-key", &key.span(), message);
            let meant = suggest::nearest(name, mine.iter().copied());
            let meant = meant.map(|m| format!("did you mean `{m}`? ")).unwrap_or_default();
            error.help = Some(format!("{meant}`{name}` goes with {}", one_of(&others)));
        }
    }

    fn unknown(&self) -> Vec<(&'r toml::Spanned<toml::de::DeString<'i>>, &'r Node<'i>)> {
        let asked = |key: &str| self.asked.contains(&key);
        self.values.iter().filter(|(key, _)| !asked(key.get_ref())).collect()
    }

    fn refuse_unknown(&mut self) {
        for (key, _) in self.unknown() {
            let message = match self.title.as_str() {
                "" => format!("{} is not a key of a scene", suggest::key(key.get_ref())),
                title => format!("{} is not a key of `{title}`", suggest::key(key.get_ref())),
            };
            let help = (!self.report.is_full())
                .then(|| suggest::hint(key.get_ref(), &self.asked, suggest::key, "its keys are"));
            self.report.error("unknown-key", &key.span(), message).help = help;
        }
    }

    /// Keys of different groups exclude each other; with `required`, one group must be there.
    pub fn one_of(&mut self, required: bool, groups: &[&[&'static str]]) {
        if let Some(notes) = &mut self.notes {
            let groups = groups.iter().map(|g| g.to_vec()).collect();
            notes.rule(Rule { required, groups });
            return;
        }
        let present: Vec<_> = groups
            .iter()
            .filter_map(|group| group.iter().find(|key| self.has(key)))
            .map(|key| (*key, self.key_place(key)))
            .collect();
        let mut order = present;
        order.sort_by_key(|(_, at)| at.start);
        match order.as_slice() {
            [] if required => {
                let keys = groups.iter().map(|g| format!("`{}`", g[0])).collect::<Vec<_>>();
                let message = format!("`{}` needs {}", self.title, keys.join(" or "));
                self.report.error("missing-key", &self.at, message);
            }
            [(first, first_at), rest @ ..] => {
                for (key, at) in rest {
                    let message = format!("`{key}` cannot be combined with `{first}`");
                    let other = self.report.span(first_at);
                    let error = self.report.error("conflicting-keys", at, message);
                    error.help = Some(format!("remove `{key}` or `{first}`"));
                    error.related = Some((other, format!("`{first}` is here")));
                }
            }
            [] => {}
        }
    }

    /// Reports something about the value of a key.
    pub fn refuse(&mut self, name: &'static str, key: &str, message: &str, help: &str) {
        let at = self.place(key);
        let error = self.report.error(name, &at, message);
        error.help = (!help.is_empty()).then(|| help.to_owned());
    }
}

/// The keys that a variant's reader asks for.
fn keys_of<T>(read: fn(&mut Table) -> Option<T>) -> Vec<&'static str> {
    let (mut report, nothing) = (Report::default(), DeTable::new());
    let mut notes = Notes::default();
    let mut table = Table::new(&mut report, &nothing, "", 0..0, None);
    table.notes = Some(&mut notes);
    read(&mut table);
    table.asked
}

