//! Names of light groups.

use serde_json::{Value as Json, json};

use super::{
    report::Report,
    value::{Named, Value},
};
use crate::syntax::Node;
use crate::{desc::LightGroup, range::Range, suggest};

impl Value for LightGroup {
    fn expected() -> String {
        String::expected()
    }
    fn schema(_: &Range) -> Json {
        json!({ "type": "string", "pattern": "^[A-Za-z0-9_-]{1,31}$" })
    }
    fn to_json(&self) -> Json {
        json!(self.name())
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let name = String::read(node, named, report)?;
        let group = Self::new(&name);
        if group.is_none() {
            let (key, most, name) = (named.key, Self::MOST, suggest::text(&name));
            let message =
                format!("`{key}` must be 1 to {most} letters, digits, `-` and `_`, not {name}");
            let error = report.error("wrong-name", &node.span(), message);
            error.help = Some("the name stands in names of layers, such as `light_key.R`".into());
        }
        group
    }
}
