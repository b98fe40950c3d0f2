//! Messages about a scene as JSON, with their places in the text.

use serde_json::{Value, json};

use reflet_lsp::range;
use reflet_scene::diagnostic::{Diagnostic, at_most};

/// Messages with their file and, where they are about a place, its range in the form of the language server.
pub fn messages(found: Vec<Diagnostic>) -> Vec<Value> {
    let message = |found: Diagnostic| {
        let source = found.span.source.as_ref();
        json!({
            "severity": found.severity.name(),
            "file": found.path(),
            "range": source.map(|source| range(&source.text, &found.span.range)),
            "text": found.render(false),
        })
    };
    at_most(found).into_iter().map(message).collect()
}
