//! Entries of the scene's own text, which warnings about keys and values go through.

use std::sync::Arc;

use crate::scene::{
    diagnostic::{Diagnostic, Source, Span},
    syntax::{Content, Entries, Key, Node},
};

/// A warning at a place, with advice.
pub fn warning(name: &'static str, at: &Span, message: String, help: &str) -> Diagnostic {
    Diagnostic::new(name, at.clone(), message).help(help)
}

/// An entry of the scene's text.
pub struct TextEntry<'t> {
    /// Keys of the tables around it, with dots between.
    pub table: &'t str,
    /// The entries beside it, itself included.
    pub beside: &'t Entries,
    pub key: &'t Key,
    pub node: &'t Node,
}

impl TextEntry<'_> {
    /// Its name.
    pub fn name(&self) -> &str {
        self.key.get_ref()
    }

    /// Its place in a text.
    pub fn at(&self, source: &Arc<Source>) -> Span {
        let (source, range) = (Some(Arc::clone(source)), self.key.span());
        Span { source, range }
    }
}

/// Calls a function with each entry of a table and of the tables in it; `path` has the keys of the tables around it.
pub fn each_entry(table: &Entries, path: &str, visit: &mut impl FnMut(&TextEntry)) {
    for (key, node) in table {
        let beside = table;
        visit(&TextEntry {
            table: path,
            beside,
            key,
            node,
        });
        let path = format!("{path}.{}", key.get_ref());
        let list = node.get_ref().as_array().into_iter().flatten();
        for inner in list
            .chain([node])
            .filter_map(|node| node.get_ref().as_table())
        {
            each_entry(inner, path.trim_start_matches('.'), visit);
        }
    }
}

/// Places and names of these keys in a table of the scene's text, in the order of the text.
pub fn written(start: &Span, table: &str, keys: &[&str]) -> Vec<(Span, String)> {
    let find = || {
        let source = start.source.as_ref()?;
        let root = source.syntax().root();
        let table = root.get(table)?.get_ref().as_table()?;
        let said = table
            .keys()
            .filter(|key| keys.contains(&key.get_ref().as_str()));
        let place = |range| Span {
            source: Some(source.clone()),
            range,
        };
        let said = said.map(|key| (place(key.span()), key.get_ref().to_string()));
        Some(said.collect::<Vec<_>>())
    };
    let mut found = find().unwrap_or_default();
    found.sort_by_key(|(at, _)| at.range.start);
    found
}

/// A number of the text, of either kind.
pub fn number(node: &Node) -> Option<f64> {
    match node.get_ref() {
        Content::Integer(x) => Some(x.value()? as f64),
        Content::Float(x) => x.value(),
        _ => None,
    }
}

/// A number with three digits behind the point.
pub fn rounded(x: f64) -> f64 {
    (x * 1e3).round() / 1e3 + 0.0
}
