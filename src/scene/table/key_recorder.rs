//! Record of the keys that the readers ask for: the source of the manual's tables and the JSON Schema.

use serde_json::Value as Json;

use super::value::Value;
use crate::{
    declared::{TypeDoc, Word},
    range::Range,
};

/// One allowed form of the value of a key.
#[derive(Clone, Debug)]
pub enum Form {
    /// A plain value: its description in words, and its JSON Schema.
    Value(String, Json),
    /// A table, described by the section of that type.
    Table(&'static str),
    /// Tables with names chosen by the user.
    Entries(&'static str),
    /// An array of tables.
    List(&'static str),
}

/// One key of a table.
#[derive(Clone, Debug)]
pub struct KeyRecord {
    /// Name of the key.
    pub name: &'static str,
    /// Allowed forms of its value.
    pub forms: Vec<Form>,
    /// Range of its numbers in words; empty without one.
    pub range: String,
    /// Words of which the value is one; none for other values.
    pub words: &'static [Word],
    /// Comment of a key that no type has as a field.
    pub text: Option<String>,
    /// Whether the key is required.
    pub required: bool,
    /// Default value, as in scene text.
    pub default: Option<Json>,
    /// Kinds of the entries that its text names, such as `material`; none for other keys.
    pub entries: &'static [&'static str],
    /// Extensions of the files that its text names; none for other keys.
    pub files: &'static [&'static str],
}

impl KeyRecord {
    /// A key for one form.
    pub fn new(name: &'static str, form: Form) -> Self {
        let forms = vec![form];
        Self {
            name,
            forms,
            range: String::new(),
            words: &[],
            text: None,
            required: false,
            default: None,
            entries: &[],
            files: &[],
        }
    }

    /// A key for a plain value.
    pub fn value<V: Value>(name: &'static str, range: Range) -> Self {
        let mut note = Self::new(name, Form::Value(V::expected(), V::schema(&range)));
        note.words = V::WORDS;
        if V::RANGED {
            note.range = range.words();
        }
        note
    }

    /// The same key with a further form.
    pub fn or(mut self, form: Form) -> Self {
        self.forms.push(form);
        self
    }

    /// The same key, required.
    pub fn required(mut self) -> Self {
        self.required = true;
        self
    }

    /// The same key with a default.
    pub fn default(mut self, value: Json) -> Self {
        self.default = Some(value);
        self
    }
}

/// Whether a key takes a value, by its text; `all` has the sections of tables in it.
pub fn accepts(record: &KeyRecord, text: &str, all: &[SectionRecord]) -> bool {
    let table: Option<toml::Table> = format!("x = {text}").parse().ok();
    let value = table.and_then(|mut table| serde_json::to_value(table.remove("x")?).ok());
    // Some values have "…" in them.
    value.is_none_or(|value| takes(record, &value, all))
}

fn takes(record: &KeyRecord, value: &Json, all: &[SectionRecord]) -> bool {
    let is_of_section = |table: &Json, name: &str| {
        let sections = || all.iter().filter(|section| section.type_name == name);
        let fits = |(key, value): (&String, &Json)| {
            let keys = sections().flat_map(SectionRecord::all_keys);
            let mut keys = keys.filter(|record| record.name == key).peekable();
            keys.peek().is_none() || keys.any(|record| takes(record, value, all))
        };
        table
            .as_object()
            .is_some_and(|table| table.iter().all(fits))
    };
    let is_of = |form: &Form| match form {
        Form::Value(_, schema) => is_of_schema(value, schema),
        Form::Table(name) => is_of_section(value, name),
        Form::Entries(_) => value.is_object(),
        Form::List(name) => {
            let items = value.as_array();
            items.is_some_and(|items| items.iter().all(|item| is_of_section(item, name)))
        }
    };
    record.forms.iter().any(is_of)
}

fn is_of_schema(value: &Json, schema: &Json) -> bool {
    if let Some(any) = schema["anyOf"].as_array() {
        return any.iter().any(|schema| is_of_schema(value, schema));
    }
    if let Some(words) = schema["enum"].as_array() {
        return words.contains(value);
    }
    let bound = |name: &str| schema[name].as_f64();
    let is_within = |x: f64| {
        bound("minimum").is_none_or(|least| x >= least)
            && bound("maximum").is_none_or(|most| x <= most)
            && bound("exclusiveMinimum").is_none_or(|least| x > least)
            && bound("exclusiveMaximum").is_none_or(|most| x < most)
    };
    match schema["type"].as_str() {
        Some("integer") => value
            .as_f64()
            .is_some_and(|x| x.fract() == 0.0 && is_within(x)),
        Some("number") => value.as_f64().is_some_and(is_within),
        Some("array") => value.as_array().is_some_and(|items| {
            let count = items.len() as f64;
            bound("minItems").is_none_or(|least| count >= least)
                && bound("maxItems").is_none_or(|most| count <= most)
                && items
                    .iter()
                    .all(|item| is_of_schema(item, &schema["items"]))
        }),
        Some("string") => value.is_string(),
        Some("boolean") => value.is_boolean(),
        _ => true,
    }
}

/// A rule that keys of different groups exclude each other.
#[derive(Clone, Debug)]
pub struct Rule {
    /// Whether a key of one of the groups is required.
    pub required: bool,
    /// The groups of keys.
    pub groups: Vec<Vec<&'static str>>,
}

/// A key without which other keys mean nothing.
#[derive(Clone, Debug)]
pub struct Needing {
    /// The key.
    pub key: &'static str,
    /// Keys that need it.
    pub others: &'static [&'static str],
}

/// One variant of a table: a value of `kind`, and the keys that only this variant takes.
#[derive(Clone, Debug, Default)]
pub struct VariantRecord {
    /// The key that chooses the variant, such as `kind`.
    pub key: &'static str,
    /// Value of that key.
    pub word: &'static str,
    /// Keys of the variant.
    pub keys: Vec<KeyRecord>,
    /// Rules among them.
    pub rules: Vec<Rule>,
    /// Keys that others of them need.
    pub needing: Vec<Needing>,
}

/// One table of the scene text.
#[derive(Clone, Debug, Default)]
pub struct SectionRecord {
    /// Name of its type.
    pub type_name: &'static str,
    /// Comments of its type, and of further types whose fields are its keys.
    pub docs: Vec<&'static TypeDoc>,
    /// The table as it is written, such as `[camera.NAME]`.
    pub heading: &'static str,
    /// Its keys.
    pub keys: Vec<KeyRecord>,
    /// Its variants, if it has a `kind`.
    pub variants: Vec<VariantRecord>,
    /// Rules among its keys.
    pub rules: Vec<Rule>,
    /// Keys that others of them need.
    pub needing: Vec<Needing>,
}

impl SectionRecord {
    /// All keys, of its variants too.
    pub fn all_keys(&self) -> impl Iterator<Item = &KeyRecord> {
        (self.keys.iter()).chain(self.variants.iter().flat_map(|variant| &variant.keys))
    }

    /// Its own keys by the groups of the manual; the first group, without a name, may be empty.
    pub fn groups(&self) -> impl Iterator<Item = (&'static str, Vec<&KeyRecord>)> {
        let doc = self.docs[0];
        let is_of = |group: &str, key: &&KeyRecord| doc.group_of(key.name) == group;
        let keys = move |group| self.keys.iter().filter(|key| is_of(group, key)).collect();
        doc.groups()
            .into_iter()
            .map(move |group| (group, keys(group)))
    }
}

/// All tables, in the order in which they are first met.
#[derive(Default)]
pub struct RecordedKeys {
    /// The tables.
    pub sections: Vec<SectionRecord>,
    /// Indices of the open tables, outermost first, each with whether one of its variants is open.
    open: Vec<(usize, bool)>,
}

impl RecordedKeys {
    /// Starts a table; false if it is known already.
    pub fn open(
        &mut self,
        doc: &'static TypeDoc,
        also: &'static [&'static TypeDoc],
        heading: &'static str,
    ) -> bool {
        if self.sections.iter().any(|s| s.type_name == doc.name) {
            return false;
        }
        self.open.push((self.sections.len(), false));
        self.sections.push(SectionRecord {
            type_name: doc.name,
            docs: [&[doc], also].concat(),
            heading,
            ..Default::default()
        });
        true
    }

    /// Ends the table that was started last.
    pub fn close(&mut self) {
        self.open.pop();
    }

    /// Keys, rules and needed keys of the open table or variant.
    fn open_part(&mut self) -> Option<(&mut Vec<KeyRecord>, &mut Vec<Rule>, &mut Vec<Needing>)> {
        let (index, in_variant) = *self.open.last()?;
        let section = self.sections.get_mut(index)?;
        Some(match section.variants.last_mut().filter(|_| in_variant) {
            Some(part) => (&mut part.keys, &mut part.rules, &mut part.needing),
            None => (&mut section.keys, &mut section.rules, &mut section.needing),
        })
    }

    fn set_in_variant(&mut self, value: bool) {
        if let Some(open) = self.open.last_mut() {
            open.1 = value;
        }
    }

    /// Adds a key to the open table or variant.
    pub fn add(&mut self, key: KeyRecord) {
        if let Some((keys, ..)) = self.open_part() {
            keys.push(key);
        }
    }

    /// Adds a rule to the open table or variant.
    pub fn rule(&mut self, rule: Rule) {
        if let Some((_, rules, _)) = self.open_part() {
            rules.push(rule);
        }
    }

    /// Adds a key that others need to the open table or variant.
    pub fn needing(&mut self, needing: Needing) {
        if let Some((.., all)) = self.open_part() {
            all.push(needing);
        }
    }

    /// Changes a key of the last variant of the open table that has it, or else of the table itself.
    pub fn change(&mut self, name: &str, change: impl FnOnce(&mut KeyRecord)) {
        let index = self.open.last().map(|(index, _)| *index);
        if let Some(section) = index.and_then(|index| self.sections.get_mut(index)) {
            let variants = section.variants.iter_mut().flat_map(|v| &mut v.keys);
            let mut keys = section.keys.iter_mut().chain(variants);
            keys.rfind(|key| key.name == name).map(change);
        }
    }

    /// Starts a variant of the open table; keys and rules that follow belong to it.
    pub fn open_variant(&mut self, key: &'static str, word: &'static str) {
        self.set_in_variant(true);
        let open = self.open.last().map(|(index, _)| *index);
        if let Some(section) = open.and_then(|index| self.sections.get_mut(index)) {
            section.variants.push(VariantRecord {
                key,
                word,
                ..Default::default()
            });
        }
    }

    /// Ends the variants; keys and rules that follow belong to the table itself again.
    pub fn close_variants(&mut self) {
        self.set_in_variant(false);
    }
}
