//! Lists of points, and of numbers.

use std::sync::Arc;

use serde_json::{Value as Json, json};

use super::{
    report::Report,
    value::{Named, Value, wrong_type},
    value_advice::in_a_list,
};
use crate::range::Range;
use crate::syntax::{Content, Node};
use crate::toml_text::read_floats;

/// Points of `N` numbers each, as many as there are.
pub struct Points<const N: usize>(pub Vec<[f32; N]>);

impl<const N: usize> Value for Points<N> {
    const RANGED: bool = true;

    fn expected() -> String {
        format!("an array of points, each {}", <[f32; N]>::expected())
    }
    fn schema(range: &Range) -> Json {
        json!({ "type": "array", "items": <[f32; N]>::schema(range), "minItems": 2 })
    }
    fn to_json(&self) -> Json {
        self.0.iter().map(Value::to_json).collect()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        items(node, named, &Self::expected(), report).map(Self)
    }
}

/// Values of one form, as many as there are.
pub struct List<T>(pub Vec<T>);

impl<T: Value> Value for List<T> {
    const RANGED: bool = T::RANGED;

    fn expected() -> String {
        format!("an array, each item {}", T::expected())
    }
    fn schema(range: &Range) -> Json {
        json!({ "type": "array", "items": T::schema(range) })
    }
    fn to_json(&self) -> Json {
        self.0.iter().map(Value::to_json).collect()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        if let Some(help) = in_a_list(node, named.key) {
            wrong_type(node, named.key, &Self::expected(), report).help = Some(help);
            return None;
        }
        items(node, named, &Self::expected(), report).map(Self)
    }
}

/// The values of an array; every one is read, so that every wrong one is reported.
fn items<T: Value>(
    node: &Node,
    named: &Named,
    expected: &str,
    report: &mut Report,
) -> Option<Vec<T>> {
    let Some(items) = node.get_ref().as_array() else {
        wrong_type(node, named.key, expected, report);
        return None;
    };
    let read = |(i, item)| {
        let key = format!("{}[{i}]", named.key);
        let named = Named {
            key: &key,
            range: named.range,
        };
        T::read(item, &named, report)
    };
    let values: Vec<Option<T>> = items.iter().enumerate().map(read).collect();
    values.into_iter().collect()
}

/// Many numbers: an array of them or of points, or a script's `floats`.
pub struct Numbers(pub Arc<[f32]>);

impl Value for Numbers {
    const RANGED: bool = true;

    fn expected() -> String {
        "an array of numbers or of points; in scripts `floats`".into()
    }
    fn schema(range: &Range) -> Json {
        let number = f32::schema(range);
        let point = json!({ "type": "array", "items": number });
        json!({ "type": "array", "items": { "anyOf": [number, point] } })
    }
    fn to_json(&self) -> Json {
        self.0.iter().map(Value::to_json).collect()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        if let Some(read) = node.get_ref().as_str().and_then(read_floats) {
            let wrong = |x: &f32| !x.is_finite() || named.range.check(f64::from(*x)).is_err();
            let Some(index) = read.iter().position(wrong) else {
                return Some(Self(read.into()));
            };
            let (key, words) = (named.key, named.range.words());
            let message = format!("`{key}[{index}]` must be {words}, not {}", read[index]);
            report.error("out-of-range", &node.span(), message);
            return None;
        }
        let Some(items) = node.get_ref().as_array() else {
            wrong_type(node, named.key, &Self::expected(), report);
            return None;
        };
        let mut all = Vec::with_capacity(items.len());
        let errors = report.errors();
        for (index, item) in items.iter().enumerate() {
            let key = format!("{}[{index}]", named.key);
            let range = named.range;
            if let Content::Array(point) = item.get_ref() {
                for (index, item) in point.iter().enumerate() {
                    let key = &format!("{key}[{index}]");
                    all.extend(f32::read(item, &Named { key, range }, report));
                }
            } else {
                all.extend(f32::read(item, &Named { key: &key, range }, report));
            }
        }
        (report.errors() == errors).then(|| Self(all.into()))
    }
}
