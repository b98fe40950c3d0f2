//! `[params]`: values with names of the user's choice, which the script reads.

use serde_json::{Value as Json, json};
use toml::de::{DeTable, DeValue};

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

/// A number that 32 bits hold, kept with all its digits.
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
