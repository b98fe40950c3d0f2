//! Messages about a scene as JSON, with their places in the text.

use serde_json::{Value, json};

use reflet_scene::diagnostic::{Diagnostic, at_most};

/// Messages with the file, line and columns that they are about, where they are about a place.
pub fn messages(found: Vec<Diagnostic>) -> Vec<Value> {
    let message = |found: Diagnostic| {
        let at = found.span.source.as_ref().map(|source| {
            let [start, end] = [found.span.range.start, found.span.range.end];
            (source.place(start), source.place(end))
        });
        json!({
            "severity": found.severity.name(),
            "file": found.path(),
            "line": at.map(|(start, _)| start.line),
            "column": at.map(|(start, _)| start.column),
            "end": at.map(|(_, end)| [end.line, end.column]),
            "text": found.render(false),
        })
    };
    at_most(found).into_iter().map(message).collect()
}
