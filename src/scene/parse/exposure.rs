//! Exposure: stops, or `"auto"`.

use serde_json::{Value as Json, json};

use super::{
    report::Report,
    value::{Named, Value, wrong_type},
};
use crate::syntax::{Content, Node};
use crate::{desc::Exposure, range::Range, suggest};

const AUTO: &str = "auto";

impl Value for Exposure {
    const RANGED: bool = true;

    fn expected() -> String {
        format!("a number or \"{AUTO}\"")
    }
    fn schema(range: &Range) -> Json {
        json!({ "anyOf": [f32::schema(range), { "const": AUTO }] })
    }
    fn to_json(&self) -> Json {
        match self {
            Self::Ev(ev) => ev.to_json(),
            Self::Auto => json!(AUTO),
        }
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        match node.get_ref() {
            Content::String(text) if text == AUTO => Some(Self::Auto),
            Content::String(text) => {
                let (key, shown) = (named.key, suggest::text(text));
                let message = format!("`{key}` must be {}, not {shown}", Self::expected());
                let error = report.error("wrong-value", &node.span(), message);
                error.help = Some(format!("write stops, such as 1.5, or \"{AUTO}\""));
                None
            }
            Content::Integer(_) | Content::Float(_) => f32::read(node, named, report).map(Self::Ev),
            _ => {
                wrong_type(node, named.key, &Self::expected(), report);
                None
            }
        }
    }
}
