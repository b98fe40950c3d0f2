//! Light groups: lights, emitting surfaces and the environment whose light a picture also shows apart.

use std::fmt;

use serde_json::{Value as Json, json};

use crate::{
    range::{ANY, Range},
    suggest,
    syntax::Node,
    table::{
        Table,
        report::Report,
        value::{Named, Value},
    },
};

/// Name of a light group; it lies in place, so that descriptions of lights stay plain data. The default is the group
/// [`LightGroup::OTHER`] of all that name none.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LightGroup([u8; LightGroup::MOST]);

impl LightGroup {
    /// Largest length of a name, bytes.
    pub const MOST: usize = 31;
    /// Name of the group of everything without one.
    pub const OTHER: &'static str = "other";
    /// Name that stands for all groups of a scene where pictures of groups are asked for.
    pub const ALL: &'static str = "*";

    /// The group of a name; `None` where that is not of 1 to 31 letters, digits, `-` and `_`.
    pub fn new(name: &str) -> Option<Self> {
        let is_known = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        if name.is_empty() || name.len() > Self::MOST || !name.chars().all(is_known) {
            return None;
        }
        if name == Self::OTHER {
            return Some(Self::default());
        }
        let mut bytes = [0; Self::MOST];
        bytes[..name.len()].copy_from_slice(name.as_bytes());
        Some(Self(bytes))
    }

    /// Name of the group.
    pub fn name(&self) -> &str {
        let length = self.0.iter().take_while(|byte| **byte != 0).count();
        match str::from_utf8(&self.0[..length]) {
            Ok(name) if length > 0 => name,
            _ => Self::OTHER,
        }
    }

    /// Reads `light_group` of a table; [`LightGroup::OTHER`] where it is left out.
    pub fn find(t: &mut Table) -> Option<Self> {
        Some(t.find("light_group", ANY).unwrap_or_default())
    }

    /// Whether this is a group that some thing names.
    pub fn is_named(&self) -> bool {
        *self != Self::default()
    }
}

impl fmt::Debug for LightGroup {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Debug::fmt(self.name(), f)
    }
}

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
