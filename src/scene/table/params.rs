//! `[params]`: values with names that the user chooses, for the script.

use serde_json::{Value as Json, json};

use super::{
    located::Entry,
    report::Report,
    value::{Named, Value as _, wrong_type},
};
use crate::syntax::{Content, Entries, Key, Node, in_order};
use crate::{range::ANY, suggest};

const EXPECTED: &str = "a number, text in quotes, true or false, or an array of numbers";

/// A parameter of the scene's script.
#[derive(Clone, Debug, PartialEq)]
pub enum ParamValue {
    /// A number written without a decimal point.
    Integer(i64),
    /// A number written with a decimal point.
    Number(f64),
    /// `true` or `false`.
    Switch(bool),
    /// Text.
    Text(String),
    /// An array of numbers.
    Numbers(Vec<f64>),
}

/// JSON Schema of the table.
pub fn schema() -> Json {
    let types = ["number", "string", "boolean"].map(|kind| json!({ "type": kind }));
    let numbers = json!({ "type": "array", "items": { "type": "number" } });
    let any: Vec<_> = types.into_iter().chain([numbers]).collect();
    json!({ "type": "object", "additionalProperties": { "anyOf": any } })
}

/// All parameters in the order of the file.
pub fn read(values: &Entries, report: &mut Report) -> Vec<Entry<ParamValue>> {
    let mut params = Vec::new();
    for (name, node) in in_order(values) {
        if let Some(value) = value(node, name.get_ref(), report) {
            params.push(Entry {
                name: name.get_ref().to_string(),
                at: report.span(&name.span()),
                value,
            });
        }
    }
    params
}

fn value(node: &Node, key: &str, report: &mut Report) -> Option<ParamValue> {
    match node.get_ref() {
        Content::Integer(_) | Content::Float(_) => {
            let x = number(node, key, report)?;
            let whole = matches!(node.get_ref(), Content::Integer(_))
                && !report.is_float(node.span().start);
            Some(if whole {
                ParamValue::Integer(x as i64)
            } else {
                ParamValue::Number(x)
            })
        }
        Content::Boolean(b) => Some(ParamValue::Switch(*b)),
        Content::String(text) => Some(ParamValue::Text(text.to_string())),
        Content::Array(items) => {
            let numbers: Vec<_> = items.iter().map(|i| number(i, key, report)).collect();
            numbers
                .into_iter()
                .collect::<Option<_>>()
                .map(ParamValue::Numbers)
        }
        other => {
            let inner = other.as_table().and_then(|table| table.keys().next());
            let name = inner.map_or("x", |inner| inner.get_ref().as_str());
            let help = format!(
                "write a parameter for each value, as in `{} = …`",
                suggest::clip(&format!("{key}_{name}"))
            );
            wrong_type(node, &suggest::clip(key), EXPECTED, report).help = Some(help);
            None
        }
    }
}

/// A number within the range of 32-bit floats, kept in double precision.
fn number(node: &Node, key: &str, report: &mut Report) -> Option<f64> {
    let named = Named {
        key: &suggest::clip(key),
        range: &ANY,
    };
    f32::read(node, &named, report)?;
    match node.get_ref() {
        Content::Integer(i) => i.value().map(|x| x as f64),
        Content::Float(x) => x.value(),
        _ => None,
    }
}

/// Gives a declared parameter another value of its kind.
pub fn set(declared: &mut Entries, key: Key, value: Node, report: &mut Report) {
    let name = key.get_ref();
    let Some(old) = declared.get(name.as_str()) else {
        let names: Vec<_> = declared.keys().map(|k| k.get_ref().as_str()).collect();
        let message = format!("no parameter is named {}", suggest::text(name));
        let help = match names.is_empty() {
            true => "the scene has no `[params]`".to_owned(),
            false => suggest::hint(name, &names, suggest::text, "the names are"),
        };
        report.error("dangling-name", &key.span(), message).help = Some(help);
        return;
    };
    if !fits(old, &value, report) {
        let (own, key) = (kind(old.get_ref()), suggest::key(name));
        let (other, help) = match (old.get_ref(), value.get_ref()) {
            (Content::Integer(i), Content::Float(x)) => {
                let help = format!("declared as {i}.0 in `[params]` it takes any number");
                (x.to_string(), Some(help))
            }
            (_, other) => (kind(other), None),
        };
        let message = format!("{key} is {own}, not {other}");
        report.error("wrong-type", &value.span(), message).help = help;
        return;
    }
    // A parameter that is declared as a float stays one, also where it is set to 3.
    if matches!(old.get_ref(), Content::Float(_)) || report.is_float(old.span().start) {
        report.keep_float(value.span().start);
    }
    // Removed first, so that the key gets the position of the new value.
    declared.remove(key.get_ref().as_str());
    declared.insert(key, value);
}

/// Whether a value keeps the kind of a parameter; a list also its length, as each element may have its
/// own meaning.
fn fits(declared: &Node, value: &Node, report: &Report) -> bool {
    match (declared.get_ref(), value.get_ref()) {
        (Content::Float(_), Content::Integer(_)) => true,
        // A float that an earlier override has set to 3 is still a float.
        (Content::Integer(_), Content::Float(_)) => report.is_float(declared.span().start),
        (Content::Array(a), Content::Array(b)) => a.len() == b.len(),
        (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

/// The kind of a parameter, in words.
fn kind(value: &Content) -> String {
    match value {
        Content::String(_) => "a text".into(),
        Content::Integer(_) => "a whole number".into(),
        Content::Float(_) => "a number".into(),
        Content::Boolean(_) => "true or false".into(),
        Content::Datetime => "a date".into(),
        Content::Array(items) => format!("a list of {}", items.len()),
        Content::Table(_) => "a table".into(),
    }
}
