//! `[params]`: values with names that the user chooses, for the script.

use serde_json::{Value as Json, json};
use toml::{
    Spanned,
    de::{DeString, DeTable, DeValue},
};

use super::{
    report::Report,
    value::{Named, Node, Value as _, wrong_type},
};
use crate::scene::desc::{Entry, ParamValue};
use crate::scene::{range::ANY, suggest};

const EXPECTED: &str = "a number, text in quotes, true or false, or an array of numbers";

/// JSON Schema of the table.
pub fn schema() -> Json {
    let types = ["number", "string", "boolean"].map(|kind| json!({ "type": kind }));
    let numbers = json!({ "type": "array", "items": { "type": "number" } });
    let any: Vec<_> = types.into_iter().chain([numbers]).collect();
    json!({ "type": "object", "additionalProperties": { "anyOf": any } })
}

/// All parameters in the order of the file.
pub fn read(values: &DeTable, report: &mut Report) -> Vec<Entry<ParamValue>> {
    let mut all: Vec<_> = values.iter().collect();
    all.sort_by_key(|(name, _)| name.span().start);
    let mut params = Vec::new();
    for (name, node) in all {
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
        DeValue::Integer(_) | DeValue::Float(_) => {
            let x = number(node, key, report)?;
            let whole = matches!(node.get_ref(), DeValue::Integer(_))
                && !report.is_float(node.span().start);
            Some(if whole {
                ParamValue::Integer(x as i64)
            } else {
                ParamValue::Number(x)
            })
        }
        DeValue::Boolean(b) => Some(ParamValue::Switch(*b)),
        DeValue::String(text) => Some(ParamValue::Text(text.to_string())),
        DeValue::Array(items) => {
            let numbers: Vec<_> = items.iter().map(|i| number(i, key, report)).collect();
            numbers
                .into_iter()
                .collect::<Option<_>>()
                .map(ParamValue::Numbers)
        }
        _ => {
            wrong_type(node, &suggest::clip(key), EXPECTED, report);
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
        DeValue::Integer(i) => i128::from_str_radix(i.as_str(), i.radix())
            .ok()
            .map(|x| x as f64),
        DeValue::Float(f) => f.as_str().parse().ok(),
        _ => None,
    }
}

/// Gives a declared parameter another value of its kind.
pub fn set<'i>(
    declared: &mut DeTable<'i>,
    key: Spanned<DeString<'i>>,
    value: Node<'i>,
    report: &mut Report,
) {
    let name = key.get_ref();
    let Some(old) = declared.get(name.as_ref()) else {
        let names: Vec<_> = declared.keys().map(|k| k.get_ref().as_ref()).collect();
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
            (DeValue::Integer(i), DeValue::Float(x)) => {
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
    if matches!(old.get_ref(), DeValue::Float(_)) || report.is_float(old.span().start) {
        report.keep_float(value.span().start);
    }
    // Removed first, so that the key's position is that of the new value.
    declared.remove(key.get_ref().as_ref());
    declared.insert(key, value);
}

/// Whether a value keeps the kind of a parameter; a list also its length, as each element may have its
/// own meaning.
fn fits(declared: &Node, value: &Node, report: &Report) -> bool {
    match (declared.get_ref(), value.get_ref()) {
        (DeValue::Float(_), DeValue::Integer(_)) => true,
        // A float that an earlier override has set to 3 is still a float.
        (DeValue::Integer(_), DeValue::Float(_)) => report.is_float(declared.span().start),
        (DeValue::Array(a), DeValue::Array(b)) => a.len() == b.len(),
        (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

/// The kind of a parameter, in words.
fn kind(value: &DeValue) -> String {
    match value {
        DeValue::String(_) => "a text".into(),
        DeValue::Integer(_) => "a whole number".into(),
        DeValue::Float(_) => "a number".into(),
        DeValue::Boolean(_) => "true or false".into(),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(items) => format!("a list of {}", items.len()),
        DeValue::Table(_) => "a table".into(),
    }
}
