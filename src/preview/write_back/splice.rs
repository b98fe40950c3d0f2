//! Numbers of one table of scene text, changed in place: every other byte of the text stays.

use std::ops::Range;

use reflet_scene::syntax::{Content, Entries, Node};

/// Locator of a table in a scene text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Locator {
    /// Keys of the tables around it, such as `variant` and its name; empty at the top.
    pub above: Vec<String>,
    /// Key of the table's kind: `instance`, `light`, …
    pub kind: &'static str,
    /// Selector of one of the tables of the kind.
    pub selector: Selector,
}

/// Selector of one of several tables.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Selector {
    /// `[kind.NAME]`, or `[[kind]]` with this `name`.
    Name(String),
    /// Index of a `[[kind]]` table, from 0.
    Index(usize),
}

/// Number of decimals that are written.
const DECIMALS: i32 = 6;

/// Tables that contain items: the whole file, then its variants.
pub fn roots(root: &Entries) -> Vec<(Vec<String>, &Entries)> {
    let variants = root.get("variant").and_then(|v| v.get_ref().as_table());
    let variants = variants.into_iter().flat_map(|all| all.iter());
    let tables = variants.filter_map(|(name, node)| {
        let above = vec!["variant".to_owned(), name.get_ref().to_string()];
        Some((above, node.get_ref().as_table()?))
    });
    std::iter::once((Vec::new(), root)).chain(tables).collect()
}

/// Table that a locator points to.
pub fn find<'n>(root: &'n Entries, locator: &Locator) -> Option<&'n Node> {
    let mut table = root;
    for name in &locator.above {
        table = table.get(name.as_str())?.get_ref().as_table()?;
    }
    match (table.get(locator.kind)?.get_ref(), &locator.selector) {
        (Content::Table(all), Selector::Name(name)) => all.get(name.as_str()),
        (Content::Array(all), Selector::Index(index)) => all.get(*index),
        (Content::Array(all), Selector::Name(name)) => {
            all.iter().find(|item| name_of(item) == Some(name))
        }
        _ => None,
    }
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

fn number(node: &Node) -> Option<f64> {
    match node.get_ref() {
        Content::Integer(i) => i.value().map(|i| i as f64),
        Content::Float(x) => x.value(),
        _ => None,
    }
}

/// A number as written: whole numbers have no decimal point.
pub fn shown(value: f64) -> String {
    let scale = 10_f64.powi(DECIMALS);
    let rounded = (value * scale).round() / scale;
    // Turns -0 into 0.
    format!("{}", rounded + 0.0)
}

fn list(values: &[f64]) -> String {
    match values {
        [one] => shown(*one),
        several => {
            let texts: Vec<_> = several.iter().map(|x| shown(*x)).collect();
            format!("[{}]", texts.join(", "))
        }
    }
}

/// The text with other numbers for a key of a table. A single number stays single if all new values are
/// equal.
///
/// # Errors
/// The node is not a table, or the key's value is not made of numbers.
pub fn put(text: &str, node: &Node, key: &str, values: &[f64]) -> Result<String, String> {
    let Content::Table(table) = node.get_ref() else {
        return Err("it is not written as a table".to_owned());
    };
    let Some(old) = table.get(key) else {
        return Ok(insert(text, node, table, key, values));
    };
    let mut parts: Vec<(Range<usize>, String)> = Vec::new();
    match old.get_ref() {
        Content::Array(items) if items.len() == values.len() => {
            for (item, value) in items.iter().zip(values) {
                let before = number(item).ok_or("it is not written as numbers")?;
                if shown(before) != shown(*value) {
                    parts.push((item.span(), shown(*value)));
                }
            }
        }
        Content::Integer(_) | Content::Float(_) => {
            let alike = values
                .windows(2)
                .all(|pair| shown(pair[0]) == shown(pair[1]));
            let new = if alike { &values[..1] } else { values };
            parts.push((old.span(), list(new)));
        }
        _ => parts.push((old.span(), list(values))),
    }
    let mut out = text.to_owned();
    for (at, new) in parts.into_iter().rev() {
        out.replace_range(at, &new);
    }
    Ok(out)
}

/// The text with one more key in a table.
fn insert(text: &str, node: &Node, table: &Entries, key: &str, values: &[f64]) -> String {
    let line = format!("{key} = {}", list(values));
    let at = node.span();
    let is_inline = text[at.start..].starts_with('{');
    // Subtables with headers of their own come after the table's keys.
    let is_own = |value: &Node| !text[value.span().start..].starts_with('[') || !is_table(value);
    let own = table.values().filter(|value| is_own(value));
    let last = own.map(|value| value.span().end).max();
    let mut out = text.to_owned();
    if is_inline {
        match last {
            Some(end) => out.insert_str(end, &format!(", {line}")),
            None => out.replace_range(at, &format!("{{ {line} }}")),
        }
        return out;
    }
    let from = last.unwrap_or(at.end).max(at.end);
    let end = text[from..].find('\n').map_or(text.len(), |end| from + end);
    let is_windows = text[..end].ends_with('\r');
    let (end, newline) = if is_windows {
        (end - 1, "\r\n")
    } else {
        (end, "\n")
    };
    out.insert_str(end, &format!("{newline}{line}"));
    out
}

fn is_table(node: &Node) -> bool {
    match node.get_ref() {
        Content::Table(_) => true,
        Content::Array(items) => items.iter().any(|item| item.get_ref().as_table().is_some()),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_scene::syntax::SyntaxTree;

    const TEXT: &str = "version = 1 # one\r\n[[instance]]\r\n  name = \"a\" # its name\r\n  translation = [ 1.50, 2, # two\r\n    -3 ]\r\n[instance.material]\r\nroughness = 1\r\n# of b\r\n[[instance]]\r\nname = \"b\"\r\n[light.\"old lamp\"]\r\nscale = 2 # twice\r\n[variant.night.light.x]\r\n";

    fn changed(kind: &'static str, selector: Selector, key: &str, values: &[f64]) -> String {
        let tree = SyntaxTree::parse(TEXT);
        let root = tree.correct().expect("it is right");
        let locator = Locator {
            above: Vec::new(),
            kind,
            selector,
        };
        let node = find(root, &locator).expect("it is there");
        put(TEXT, node, key, values).expect("it can be put")
    }

    #[test]
    fn only_what_changes_is_written() {
        let named = |name: &str| Selector::Name(name.to_owned());
        for (kind, selector, key, values, from, to) in [
            (
                "instance",
                named("a"),
                "translation",
                &[1.5, 2.0, -3.0][..],
                "",
                "",
            ),
            (
                "instance",
                named("a"),
                "translation",
                &[1.5, 2.25, -3.0],
                "1.50, 2,",
                "1.50, 2.25,",
            ),
            (
                "instance",
                Selector::Index(0),
                "translation",
                &[-0.000_000_1, 2.0, 4.0],
                "[ 1.50, 2, # two\r\n    -3 ]",
                "[ 0, 2, # two\r\n    4 ]",
            ),
            (
                "instance",
                named("a"),
                "scale",
                &[2.0],
                "    -3 ]\r\n",
                "    -3 ]\r\nscale = 2\r\n",
            ),
            (
                "instance",
                named("b"),
                "scale",
                &[1.0, 2.0, 0.1],
                "name = \"b\"\r\n",
                "name = \"b\"\r\nscale = [1, 2, 0.1]\r\n",
            ),
            (
                "light",
                named("old lamp"),
                "scale",
                &[3.0, 3.0, 3.0],
                "scale = 2 #",
                "scale = 3 #",
            ),
            (
                "light",
                named("old lamp"),
                "scale",
                &[3.0, 1.0, 3.0],
                "scale = 2 #",
                "scale = [3, 1, 3] #",
            ),
        ] {
            let found = changed(kind, selector, key, values);
            assert_eq!(found, TEXT.replacen(from, to, 1), "{kind} {key}");
            assert!(SyntaxTree::parse(&found).correct().is_ok());
        }
    }

    #[test]
    fn inline_and_empty_tables_take_new_keys() {
        let text = "light = { a = { kind = \"point\" }, b = {} }\n[light2]\n[light2.c] # c\n";
        let tree = SyntaxTree::parse(text);
        let root = tree.correct().expect("it is right");
        let of = |kind, name: &str| {
            let selector = Selector::Name(name.to_owned());
            let locator = Locator {
                above: Vec::new(),
                kind,
                selector,
            };
            let node = find(root, &locator).expect("it is there");
            put(text, node, "position", &[0.0, 1.0]).expect("it can be put")
        };
        let a = of("light", "a");
        assert!(a.contains("{ kind = \"point\", position = [0, 1] }"), "{a}");
        assert!(of("light", "b").contains("b = { position = [0, 1] }"));
        assert!(of("light2", "c").ends_with("[light2.c] # c\nposition = [0, 1]\n"));
    }
}
