//! Tables inside tables: single, by name, in lists, or in place of a name.

use serde_json::json;

use super::{
    Place, Section, Table,
    key_recorder::{Form, KeyRecord, RecordedKeys},
    located::{At, Entry, Written},
    params::{self, ParamValue},
    report::Report,
    value::{Named, Value, found, wrong_type},
    value_advice::{list_instead, text_instead, unquoted},
};
use crate::syntax::{Content, Entries, Key, Node, in_order, key_text, made};
use crate::{
    range::{ANY, Range},
    suggest,
};

/// A name, or a table in its place.
pub enum Either<T> {
    /// The name.
    Name(At<String>),
    /// The value that the table describes.
    Nested(T),
}

/// A number, or a table in its place.
pub enum NumberOr<T> {
    /// The number.
    Number(u32),
    /// The value that the table describes.
    Nested(T),
}

/// A value, or a table in its place.
pub enum ValueOr<V, T> {
    /// The value.
    Value(V),
    /// The description that the table gives.
    Table(T),
}

impl<'r> Table<'r> {
    /// Place of the value of a key in a table of this one, where it is written.
    pub fn written_in(&self, table: &str, key: &str) -> Option<Written> {
        let nested = self.values.get(table)?.get_ref().as_table()?;
        let value = nested.get(key)?;
        Some(Written(self.report.span(&value.span())))
    }

    /// The value of an optional key, or a table in its place that `read` reads; `S` describes that table.
    pub fn value_or_table<V: Value, S: Section, T>(
        &mut self,
        key: &'static str,
        range: Range,
        read: impl FnOnce(&mut Table) -> Option<T>,
    ) -> Option<ValueOr<V, T>> {
        self.note(key, || {
            KeyRecord::value::<V>(key, range).or(Form::Table(S::DOC.name))
        });
        self.describe_nested::<S>();
        let node = self.values.get(key)?;
        match node.get_ref() {
            Content::Table(values) => {
                // A color of other programs: `{ r = 1, g = 0.5, b = 0 }`.
                if let Some(help) = list_instead(node, key, 3) {
                    wrong_type(node, key, &V::expected(), self.report).help = Some(help);
                    return None;
                }
                let place = self.place.nested(key, node.span());
                Table::read_by(self.report, values, place, read).map(ValueOr::Table)
            }
            _ => {
                let value = self.plain(key, range).map(ValueOr::Value);
                if let Some(help) = S::instead(key, node).filter(|_| value.is_none()) {
                    self.report.advise(help);
                }
                value
            }
        }
    }

    /// A whole number with a default, or a table in its place.
    pub fn number_or_table<T: Section>(
        &mut self,
        key: &'static str,
        range: Range,
        default: u32,
    ) -> NumberOr<T> {
        self.note(key, || {
            KeyRecord::value::<u32>(key, range)
                .or(Form::Table(T::DOC.name))
                .default(default.to_json())
        });
        self.describe_nested::<T>();
        let node = self.values.get(key);
        let found = node.and_then(|node| match node.get_ref() {
            Content::Table(_) => self.nested(key, node).map(NumberOr::Nested),
            Content::Integer(_) | Content::Float(_) => self.plain(key, range).map(NumberOr::Number),
            _ => {
                let is_count = |text: &str| text.parse::<u32>().is_ok();
                let both = || format!("write {}, or `{}`", suggest::example_of(key), T::HEADING);
                let help = unquoted(node, is_count).unwrap_or_else(both);
                wrong_type(node, key, "a whole number or a table", self.report).help = Some(help);
                None
            }
        });
        found.unwrap_or(NumberOr::Number(default))
    }

    /// A table right of `key =`, or `[….key]`.
    pub fn table<T: Section>(&mut self, key: &'static str) -> Option<T> {
        self.note(key, || KeyRecord::new(key, Form::Table(T::DOC.name)));
        self.describe_nested::<T>();
        let node = self.values.get(key)?;
        self.nested(key, node)
    }

    /// Same as [`Table::table`]; the text `"none"` in its place is `none`.
    pub fn table_or_none<T: Section>(&mut self, key: &'static str, none: T) -> Option<T> {
        self.note(key, || {
            let word = Form::Value("\"none\"".to_owned(), json!({ "enum": ["none"] }));
            KeyRecord::new(key, word).or(Form::Table(T::DOC.name))
        });
        self.describe_nested::<T>();
        let node = self.values.get(key)?;
        match node.get_ref().as_str() {
            Some("none") => Some(none),
            _ => self.nested(key, node),
        }
    }

    /// Same as [`Table::table`], for a required key; `example` is a value of it.
    pub fn need_table<T: Section>(&mut self, key: &'static str, example: &str) -> Option<T> {
        self.note(key, || {
            KeyRecord::new(key, Form::Table(T::DOC.name)).required()
        });
        self.describe_nested::<T>();
        let Some(node) = self.values.get(key) else {
            let help = format!("write `{key} = {example}`");
            self.missing.push(self.missing_key(key, help));
            return None;
        };
        self.nested(key, node)
    }

    /// A name, or a table in its place.
    pub fn name_or_table<T: Section>(&mut self, key: &'static str) -> Option<Either<T>> {
        self.either(key, false)
    }

    fn either<T: Section>(&mut self, key: &'static str, required: bool) -> Option<Either<T>> {
        self.note(key, || KeyRecord {
            required,
            ..KeyRecord::value::<At<String>>(key, ANY).or(Form::Table(T::DOC.name))
        });
        self.describe_nested::<T>();
        let node = self.values.get(key)?;
        match node.get_ref() {
            Content::Table(_) => self.nested(key, node).map(Either::Nested),
            _ => self.name(key, node).map(Either::Name),
        }
    }

    /// Same as [`Table::name_or_table`], for a required key; a table here was resolved before, in the
    /// tree.
    pub fn need_name_or_table<T: Section>(&mut self, key: &'static str) -> Option<Either<T>> {
        if !self.has(key) {
            let help = format!("write `{key} = …`, {}", <At<String>>::expected());
            self.missing.push(self.missing_key(key, help));
        }
        self.either(key, true)
    }

    /// A name, or tables `[….key.NAME]` in its place.
    pub fn name_or_entries<T: Section>(
        &mut self,
        key: &'static str,
    ) -> Option<Either<Vec<Entry<T>>>> {
        self.note(key, || {
            KeyRecord::value::<At<String>>(key, ANY).or(Form::Entries(T::DOC.name))
        });
        self.describe_nested::<T>();
        let node = self.values.get(key)?;
        match node.get_ref() {
            Content::Table(_) => Some(Either::Nested(self.nested_entries(key, node))),
            _ => self.name(key, node).map(Either::Name),
        }
    }

    fn name(&mut self, key: &'static str, node: &Node) -> Option<At<String>> {
        if node.get_ref().as_str().is_none() {
            let error = wrong_type(node, key, "a name in quotes or a table", self.report);
            error.help = text_instead(node);
            return None;
        }
        self.plain(key, ANY)
    }

    /// All tables `[key.NAME]`, in the order of the file.
    pub fn entries<T: Section>(&mut self, key: &'static str) -> Vec<Entry<T>> {
        self.note(key, || KeyRecord::new(key, Form::Entries(T::DOC.name)));
        self.describe_nested::<T>();
        let node = self.values.get(key);
        node.map_or_else(Vec::new, |node| self.nested_entries(key, node))
    }

    /// All tables `[[key]]`.
    pub fn list<T: Section>(&mut self, key: &'static str) -> Vec<T> {
        self.note(key, || KeyRecord::new(key, Form::List(T::DOC.name)));
        self.describe_nested::<T>();
        let Some(node) = self.values.get(key) else {
            return Vec::new();
        };
        let Some(items) = node.get_ref().as_array() else {
            let message = format!("`{key}` must be a list of tables, not {}", found(node));
            let are_names = node
                .get_ref()
                .as_table()
                .is_some_and(|t| t.values().all(|v| v.get_ref().as_table().is_some()));
            let at = self.key_at(key);
            let written = self.report.span(&at);
            let text = written
                .source
                .as_ref()
                .map_or("", |source| &source.text[..written.range.start]);
            let path = match text.ends_with('.') {
                true => "variant.NAME.instance",
                false => "instance",
            };
            let error = self.report.error("wrong-type", &at, message);
            error.help = Some(match key {
                "keys" => format!("write {}", suggest::example_of(key)),
                "instance" if are_names => {
                    format!(
                        "write `[[{path}]]`, with two brackets on each side, and a `name` as its key"
                    )
                }
                "instance" => "write `[[instance]]`, with two brackets on each side".to_owned(),
                _ => format!("write `{key} = [{}]`", keys_of::<T>(&[])),
            });
            return Vec::new();
        };
        let mut are_tables = true;
        let read = |item: &Node| match item.get_ref() {
            Content::Table(values) => {
                let place = Place {
                    in_list: true,
                    ..self.place.nested(key, item.span())
                };
                Table::read(self.report, values, place)
            }
            other => {
                // The others of the list are hardly another mistake.
                if std::mem::replace(&mut are_tables, false) {
                    let message = format!("each `{key}` must be a table, not {}", found(item));
                    let values = other.as_array().map_or(&[][..], |values| values);
                    let example = format!("write `{}`", keys_of::<T>(values));
                    self.report.error("wrong-type", &item.span(), message).help = Some(example);
                }
                None
            }
        };
        items.iter().filter_map(read).collect()
    }

    /// Tables of changes to the scene, such as variants, with names that the user chooses; they are read
    /// only where they are chosen.
    pub fn changes(&mut self, key: &'static str) -> Vec<At<String>> {
        self.note(key, || {
            let what = "tables `[variant.NAME]`, each with any keys of the scene";
            let schema = json!({
                "type": "object",
                "additionalProperties": { "type": "object" },
            });
            KeyRecord::new(key, Form::Value(what.into(), schema))
        });
        let help = format!("write `[{key}.NAME]`, with a name of your choice");
        let values = self.named_values(key, "tables with names", Some(help));
        let name = |(name, node): (&Key, &Node)| {
            if node.get_ref().as_table().is_none() {
                wrong_type(node, name.get_ref(), "a table", self.report);
            }
            let (value, at) = (name.get_ref().to_string(), self.report.span(&name.span()));
            At { value, at }
        };
        values.map_or_else(Vec::new, |values| {
            in_order(values).into_iter().map(name).collect()
        })
    }

    /// A table with names that the user chooses.
    fn named_values(&mut self, key: &str, what: &str, help: Option<String>) -> Option<&'r Entries> {
        let node = self.values.get(key)?;
        if let Content::Table(values) = node.get_ref() {
            return Some(values);
        }
        wrong_type(node, key, what, self.report).help = help;
        None
    }

    /// Parameters with names that the user chooses: numbers, texts, booleans, arrays of numbers.
    pub fn params(&mut self, key: &'static str) -> Vec<Entry<ParamValue>> {
        self.note(key, || {
            let what = "numbers, texts, true or false, or arrays of numbers, with names";
            KeyRecord::new(key, Form::Value(what.into(), params::schema()))
        });
        let help = format!("write `[{key}]`, and below it a name with its value: `count = 3`");
        let values = self.named_values(key, "a table", Some(help));
        values.map_or_else(Vec::new, |values| params::read(values, self.report))
    }

    /// Values of one kind, with names that the user chooses; `what` they are, for the manual.
    pub fn values_by_name<V: Value>(
        &mut self,
        key: &'static str,
        range: Range,
        what: &str,
    ) -> Vec<Entry<V>> {
        self.note(key, || {
            let schema = json!({ "type": "object", "additionalProperties": V::schema(&range) });
            let what = format!("{what} with names, each {}", range.words());
            KeyRecord::new(key, Form::Value(what, schema))
        });
        let help = format!("write `[{key}]`, and below it a name with its value");
        let all = self.named_values(key, "a table", Some(help));
        let read = |(name, node): (&Key, &Node)| {
            let named = Named {
                key: name.get_ref(),
                range: &range,
            };
            let value = V::read(node, &named, self.report)?;
            Some(Entry {
                name: name.get_ref().to_string(),
                at: self.report.span(&name.span()),
                value,
            })
        };
        all.map_or_else(Vec::new, |all| {
            in_order(all).into_iter().filter_map(read).collect()
        })
    }

    fn describe_nested<T: Section>(&mut self) {
        if let Some(notes) = &mut self.notes {
            Table::describe::<T>(notes);
        }
    }

    fn nested<T: Section>(&mut self, key: &str, node: &Node) -> Option<T> {
        let Content::Table(values) = node.get_ref() else {
            let message = format!("`{key}` must be a table, not {}", found(node));
            let error = self.report.error("wrong-type", &node.span(), message);
            let heading = || {
                Some(format!("write `{key} = {}`", keys_of::<T>(&[])))
                    .filter(|_| !T::HEADING.is_empty())
            };
            error.help = (T::instead(key, node))
                .or_else(|| key_of_value::<T>(key, node))
                .or_else(heading);
            return None;
        };
        Table::read(self.report, values, self.place.nested(key, node.span()))
    }

    fn nested_entries<T: Section>(&mut self, key: &str, node: &Node) -> Vec<Entry<T>> {
        let place = self.place.nested(key, node.span());
        let example = format!("write `[{}.NAME]`, with a name of your choice", place.path);
        let Content::Table(entries) = node.get_ref() else {
            let message = format!("`{key}` must be tables with names, not {}", found(node));
            let first = node.get_ref().as_array().and_then(|items| items.first());
            let name =
                first.and_then(|it| it.get_ref().as_table()?.get("name")?.get_ref().as_str());
            let error = self.report.error("wrong-type", &self.key_at(key), message);
            error.help = Some(match name {
                Some(name) => format!(
                    "write `[{}.{}]` in place of the header and its `name`",
                    place.path,
                    key_text(name)
                ),
                None => example,
            });
            return Vec::new();
        };
        let mut read = Vec::new();
        let mut nameless = false;
        for (name, node) in in_order(entries) {
            let Content::Table(values) = node.get_ref() else {
                // In a table without a name in its header, every key would be the same mistake.
                if !std::mem::replace(&mut nameless, true) {
                    let (key, title) = (suggest::key(name.get_ref()), place.title());
                    let message = format!("{key} must be a table, because {title} holds names");
                    let error = self.report.error("wrong-type", &name.span(), message);
                    let named = format!("{}.NAME.{}", place.path, name.get_ref());
                    error.help = Some(format!(
                        "{example}: a name stands between, as in `{}`",
                        suggest::clip(&named)
                    ));
                }
                continue;
            };
            let place = place.nested(name.get_ref(), node.span());
            if let Some(value) = Table::read(self.report, values, place) {
                let at = self.report.span(&name.span());
                read.push(Entry {
                    name: name.get_ref().to_string(),
                    at,
                    value,
                });
            }
        }
        read
    }
}

/// Advice for a value in place of a table: the table with this value as its only key, if one key alone is a table
/// without mistakes.
fn key_of_value<T: Section>(key: &str, node: &Node) -> Option<String> {
    let value = plain(node)?;
    let mut notes = RecordedKeys::default();
    Table::describe::<T>(&mut notes);
    let fits = |record: &&KeyRecord| {
        let only = made([(record.name, node.get_ref().clone())]);
        let mut report = Report::default();
        let read = Table::read::<T>(&mut report, &only, Place::default());
        record.required && read.is_some() && report.errors() == 0
    };
    let meant = notes.sections.first()?.keys.iter().find(fits)?.name;
    Some(format!("write `{key} = {{ {meant} = {value} }}`"))
}

/// A number or a text as it is written.
fn plain(node: &Node) -> Option<String> {
    Some(match node.get_ref() {
        Content::Integer(x) => x.to_string(),
        Content::Float(x) => x.to_string(),
        Content::String(text) => suggest::text(text),
        _ => return None,
    })
}

/// A table with the keys that it must have, or the first one, which have these values where they are plain.
fn keys_of<T: Section>(values: &[Node]) -> String {
    let mut notes = RecordedKeys::default();
    Table::describe::<T>(&mut notes);
    let all = notes.sections.first().map_or(&[][..], |s| &s.keys);
    let mut keys: Vec<_> = all.iter().filter(|key| key.required).collect();
    if keys.is_empty() {
        keys.extend(all.first());
    }
    let value = |i: usize| values.get(i).and_then(plain);
    let entry = |(i, key): (usize, &&KeyRecord)| match value(i) {
        Some(value) => format!("{} = {value}", key.name),
        None => suggest::example_of(key.name).replace('`', ""),
    };
    let keys: Vec<_> = keys.iter().enumerate().map(entry).collect();
    format!("{{ {} }}", keys.join(", "))
}
