//! Values that are a number or `"auto"`.

use serde_json::{Value as Json, json};

use super::{Bounces, Exposure};
use crate::syntax::{Content, Node};
use crate::table::{report::Report, value::Named, value::Value, value::wrong_type};
use crate::{range::Range, suggest};

const AUTO: &str = "auto";

/// Implements [`Value`] for an enum of a number, of one of the types that are values themselves, and `Auto`.
macro_rules! or_auto {
    ($type:ident, $number:ident($inner:ty), $example:literal) => {
        impl Value for $type {
            const RANGED: bool = true;

            fn expected() -> String {
                format!("{} or \"{AUTO}\"", <$inner>::expected())
            }
            fn schema(range: &Range) -> Json {
                json!({ "anyOf": [<$inner>::schema(range), { "const": AUTO }] })
            }
            fn to_json(&self) -> Json {
                match self {
                    Self::$number(number) => number.to_json(),
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
                        error.help = Some(format!("write {}, or \"{AUTO}\"", $example));
                        None
                    }
                    Content::Integer(_) | Content::Float(_) => {
                        <$inner>::read(node, named, report).map(Self::$number)
                    }
                    _ => {
                        wrong_type(node, named.key, &Self::expected(), report);
                        None
                    }
                }
            }
        }
    };
}

or_auto!(Exposure, Ev(f32), "stops, such as 1.5");
or_auto!(Bounces, AtMost(u32), "a number of reflections, such as 3");
