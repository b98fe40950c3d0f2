//! Lists of points.

use serde_json::{Value as Json, json};

use super::{
    report::Report,
    value::{Named, Value, wrong_type},
};
use crate::range::Range;
use crate::syntax::Node;

/// Points of two numbers each, as many as there are.
pub struct Points(pub Vec<[f32; 2]>);

impl Value for Points {
    const RANGED: bool = true;

    fn expected() -> String {
        "an array of points, each two numbers".into()
    }
    fn schema(range: &Range) -> Json {
        json!({ "type": "array", "items": <[f32; 2]>::schema(range), "minItems": 2 })
    }
    fn to_json(&self) -> Json {
        self.0.iter().map(Value::to_json).collect()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let Some(items) = node.get_ref().as_array() else {
            wrong_type(node, named.key, &Self::expected(), report);
            return None;
        };
        let read = |(i, item)| {
            let key = format!("{}[{i}]", named.key);
            let named = Named {
                key: &key,
                range: named.range,
            };
            Value::read(item, &named, report)
        };
        // Every element is read, so that every wrong one is reported.
        let points: Vec<Option<[f32; 2]>> = items.iter().enumerate().map(read).collect();
        points.into_iter().collect::<Option<_>>().map(Self)
    }
}
