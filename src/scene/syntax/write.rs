//! Entries as scene text, for scenes that the program generates.

use std::fmt::Write as _;

use super::{Content, Entries, Node};
use crate::toml_text::toml_text;

/// Text with these entries: values first, then tables with headers.
pub fn to_text(root: &Entries) -> String {
    let mut text = String::new();
    write_table("", root, &mut text);
    text
}

fn write_table(path: &str, table: &Entries, out: &mut String) {
    let is_table = |node: &Node| matches!(node.get_ref(), Content::Table(_));
    for (key, node) in table.iter().filter(|(_, node)| !is_table(node)) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{} = {}",
            key_text(key.get_ref()),
            value_text(node.get_ref())
        );
    }
    for (key, node) in table {
        if let Content::Table(inner) = node.get_ref() {
            let dot = if path.is_empty() { "" } else { "." };
            let path = format!("{path}{dot}{}", key_text(key.get_ref()));
            let _ = writeln!(out, "[{path}]");
            write_table(&path, inner, out);
        }
    }
}

/// Key, in quotes where these are needed.
pub fn key_text(key: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    match !key.is_empty() && key.chars().all(is_bare) {
        true => key.to_owned(),
        false => toml_text(key),
    }
}

/// Content as a value in one line.
pub fn value_text(content: &Content) -> String {
    match content {
        Content::String(text) => toml_text(text),
        Content::Integer(number) => number.to_string(),
        Content::Float(number) => number.to_string(),
        Content::Boolean(value) => value.to_string(),
        Content::Datetime => String::new(), // no generated scene has one
        Content::Array(items) => {
            let items: Vec<_> = items
                .iter()
                .map(|item| value_text(item.get_ref()))
                .collect();
            format!("[{}]", items.join(", "))
        }
        Content::Table(table) => {
            let pair = |(key, node): (&super::Key, &Node)| {
                format!(
                    "{} = {}",
                    key_text(key.get_ref()),
                    value_text(node.get_ref())
                )
            };
            let pairs: Vec<_> = table.iter().map(pair).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
    }
}
