//! Types of values that keys take, for advice about text that is no TOML.

use std::{collections::HashMap, ops::RangeInclusive, sync::LazyLock};

use serde_json::Value as Json;

use crate::{
    parse::{SectionRecord, recorded_keys, recorded_project_keys},
    table::key_recorder::Form,
};

/// Numbers and lists that a key takes.
#[derive(Default)]
pub struct ValueTypes {
    pub number: bool,
    /// Whether numbers, or the elements of lists, need not be whole.
    pub fraction: bool,
    /// Allowed lengths of lists; empty where the key takes no list.
    pub lists: Vec<RangeInclusive<u64>>,
}

impl ValueTypes {
    /// Whether the key takes lists of a length.
    pub fn takes(&self, length: usize) -> bool {
        let takes = |lengths: &RangeInclusive<u64>| lengths.contains(&(length as u64));
        self.lists.iter().any(takes)
    }

    /// Adds the types of a schema, and for names of the user's choice the types of their values.
    fn add(&mut self, schema: &Json) {
        let any = schema["anyOf"].as_array().into_iter().flatten();
        any.chain(schema.get("additionalProperties"))
            .for_each(|schema| self.add(schema));
        self.number |= schema["const"].is_number();
        match schema["type"].as_str() {
            Some("array") => {
                let length = |key, default| schema[key].as_u64().unwrap_or(default);
                let lengths = length("minItems", 0)..=length("maxItems", u64::MAX);
                self.lists.push(lengths);
                self.fraction |= schema["items"]["type"] == "number";
            }
            Some(kind @ ("number" | "integer")) => {
                self.number = true;
                self.fraction |= kind == "number";
            }
            _ => {}
        }
    }
}

/// Types by the kind of the table, or [`ANY`], and by the name of the key.
type Index = HashMap<&'static str, HashMap<&'static str, ValueTypes>>;

/// Tables of all kinds.
const ANY: &str = "*";

static SCENE: LazyLock<Index> = LazyLock::new(|| index(recorded_keys()));
static PROJECT: LazyLock<Index> = LazyLock::new(|| index(recorded_project_keys()));

fn index(tables: &'static [SectionRecord]) -> Index {
    let mut index = Index::new();
    for (table, key) in (tables.iter()).flat_map(|it| it.all_keys().map(move |key| (it, key))) {
        for form in &key.forms {
            let Form::Value(_, schema) = form else {
                continue;
            };
            for kind in [kind_of(table.heading), ANY] {
                let keys = index.entry(kind).or_default();
                keys.entry(key.name).or_default().add(schema);
            }
        }
    }
    index
}

/// First word of a heading of the manual; empty for a whole file.
fn kind_of(heading: &str) -> &str {
    let is_file = !heading.contains(['[', '=']);
    let inner = heading.trim_start_matches(['[', ' ']);
    let kind = inner.split(['.', ']', ' ']).next();
    kind.filter(|_| !is_file).unwrap_or_default()
}

/// Types of a key in tables of a kind; in all tables where tables of its kind lack the key; of values by name where no
/// table has it. Keys of `[params]` are the user's.
pub fn types_of(is_project: bool, kind: &str, key: &str) -> Option<&'static ValueTypes> {
    let index: &'static Index = if is_project { &PROJECT } else { &SCENE };
    let any = if kind == "params" { kind } else { ANY };
    let places = [(kind, key), (any, key), (any, kind)];
    (places.into_iter()).find_map(|(kind, key)| index.get(kind)?.get(key))
}
