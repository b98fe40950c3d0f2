//! Messages as SARIF 2.1.0 (OASIS, Static Analysis Results Interchange Format), which editors and
//! continuous integration read.

use percent_encoding::utf8_percent_encode;
use reflet_lsp::PLAIN;
use serde_json::{Value, json};

use crate::scene::diagnostic::{Diagnostic, Span};

/// A log of one run with these messages.
pub fn log(messages: &[Diagnostic]) -> Value {
    let mut rules: Vec<&str> = messages.iter().map(|d| d.name).collect();
    rules.sort_unstable();
    rules.dedup();
    let results: Vec<Value> = messages.iter().map(|d| result(d, &rules)).collect();
    let rules: Vec<Value> = rules.iter().map(|id| json!({ "id": id })).collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "reflet",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": rules,
            } },
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    })
}

/// A result object (section 3.27 of the standard).
fn result(message: &Diagnostic, rules: &[&str]) -> Value {
    let text = match &message.help {
        Some(help) => format!("{}; {help}", message.message),
        None => message.message.clone(),
    };
    let mut result = json!({
        "ruleId": message.name,
        "ruleIndex": rules.iter().position(|rule| *rule == message.name),
        "level": message.severity.name(),
        "message": { "text": text },
    });
    if let Some(location) = location(&message.span) {
        result["locations"] = json!([location]);
    } else if let Some(file) = &message.file {
        let uri = uri(&file.display().to_string());
        result["locations"] =
            json!([{ "physicalLocation": { "artifactLocation": { "uri": uri } } }]);
    }
    if let Some((span, note)) = &message.related
        && let Some(mut location) = location(span)
    {
        location["message"] = json!({ "text": note });
        result["relatedLocations"] = json!([location]);
    }
    result
}

/// A location object (section 3.28 of the standard); columns count characters.
fn location(span: &Span) -> Option<Value> {
    let source = span.source.as_ref()?;
    let uri = uri(&source.path.display().to_string());
    if source.generated {
        return Some(json!({ "physicalLocation": { "artifactLocation": { "uri": uri } } }));
    }
    let (start, end) = (source.place(span.range.start), source.place(span.range.end));
    Some(json!({
        "physicalLocation": {
            "artifactLocation": { "uri": uri },
            "region": {
                "startLine": start.line,
                "startColumn": start.column,
                "endLine": end.line,
                "endColumn": end.column,
            },
        },
    }))
}

/// A path as a URI reference.
fn uri(path: &str) -> String {
    let path = path.replace('\\', "/");
    let scheme = if path.starts_with('/') { "file://" } else { "" };
    format!("{scheme}{}", utf8_percent_encode(&path, PLAIN))
}
