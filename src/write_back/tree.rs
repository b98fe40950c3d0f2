//! Paths to tables of scene text.

use reflet_scene::syntax::{Content, Entries, Node};

/// One step from a table to a table or list in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Key of a table.
    Key(String),
    /// Element of a list, from 0.
    Index(usize),
    /// Key of a table, or the element of a list with this `name`.
    Name(String),
}

/// Path of a table from the top of a scene text.
pub type Locator = Vec<Step>;

impl Step {
    /// Text of the step as a key.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Key(name) | Self::Name(name) => Some(name),
            Self::Index(_) => None,
        }
    }
}

/// Steps of keys.
pub fn keys<'k>(names: impl IntoIterator<Item = &'k str>) -> Locator {
    let names = names.into_iter();
    names.map(|name| Step::Key(name.to_owned())).collect()
}

/// Tables that contain items: the whole file, then its variants.
pub fn roots(root: &Entries) -> Vec<(Locator, &Entries)> {
    let variants = root.get("variant").and_then(|v| v.get_ref().as_table());
    let variants = variants.into_iter().flat_map(|all| all.iter());
    let tables = variants.filter_map(|(name, node)| {
        let above = keys(["variant", name.get_ref()]);
        Some((above, node.get_ref().as_table()?))
    });
    std::iter::once((Vec::new(), root)).chain(tables).collect()
}

/// Node that a locator points to.
pub fn find<'n>(root: &'n Entries, locator: &[Step]) -> Option<&'n Node> {
    let (first, rest) = locator.split_first()?;
    let mut node = root.get(first.key()?)?;
    for step in rest {
        node = match (node.get_ref(), step) {
            (Content::Table(all), Step::Key(name) | Step::Name(name)) => all.get(name.as_str())?,
            (Content::Array(all), Step::Index(index)) => all.get(*index)?,
            (Content::Array(all), Step::Name(name)) => {
                all.iter().find(|item| name_of(item) == Some(name))?
            }
            _ => return None,
        };
    }
    Some(node)
}

/// Value of `name` in an instance's table.
pub fn name_of(node: &Node) -> Option<&str> {
    node.get_ref().as_table()?.get("name")?.get_ref().as_str()
}

/// Numbers of a node that is a number or an array of numbers.
pub fn numbers(node: &Node) -> Option<Vec<f64>> {
    match node.get_ref() {
        Content::Array(items) => items.iter().map(number).collect(),
        _ => Some(vec![number(node)?]),
    }
}

/// A single number.
pub fn number(node: &Node) -> Option<f64> {
    match node.get_ref() {
        Content::Integer(i) => i.value().map(|i| i as f64),
        Content::Float(x) => x.value(),
        _ => None,
    }
}

/// Steps to a table below another one.
pub fn below(locator: &[Step], names: &[&str]) -> Locator {
    [locator, &keys(names.iter().copied())].concat()
}
