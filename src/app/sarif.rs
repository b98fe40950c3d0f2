//! Messages as SARIF 2.1.0 (OASIS, Static Analysis Results Interchange Format), which editors and
//! continuous integration read.

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::{Value, json};

use crate::scene::diagnostic::{Diagnostic, Severity, Span};

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
    let level = match message.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let text = match &message.help {
        Some(help) => format!("{}; {help}", message.message),
        None => message.message.clone(),
    };
    let mut result = json!({
        "ruleId": message.name,
        "ruleIndex": rules.iter().position(|rule| *rule == message.name),
        "level": level,
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

/// Characters of a path that a URI reference does not encode (RFC 3986): unreserved ones, and the slash.
pub const PLAIN: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~')
    .remove(b'/');

/// A path as a URI reference.
fn uri(path: &str) -> String {
    let path = path.replace('\\', "/");
    let scheme = if path.starts_with('/') { "file://" } else { "" };
    format!("{scheme}{}", utf8_percent_encode(&path, PLAIN))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::diagnostic::Source;

    #[test]
    fn results_have_rules_places_and_what_to_do() {
        let source = Arc::new(Source::new("my scenes/é.toml", "a = 1\nb = \"ü\" # c\n"));
        let span = |range| Span {
            source: Some(Arc::clone(&source)),
            range,
        };
        let messages = [
            Diagnostic::new("wrong-type", span(10..14), "no text")
                .help("write 2")
                .related(span(0..1), "as here"),
            Diagnostic::in_file("broken-file", "/a/b.glb".as_ref(), "cut short").warning(),
        ];
        let log = log(&messages);
        let run = &log["runs"][0];
        assert_eq!(run["tool"]["driver"]["rules"][1]["id"], "wrong-type");
        let first = &run["results"][0];
        assert_eq!(
            (&first["level"], &first["ruleIndex"]),
            (&json!("error"), &json!(1))
        );
        assert_eq!(first["message"]["text"], "no text; write 2");
        let place = &first["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "my%20scenes/%C3%A9.toml");
        let region = json!({ "startLine": 2, "startColumn": 5, "endLine": 2, "endColumn": 8 });
        assert_eq!(place["region"], region);
        assert_eq!(first["relatedLocations"][0]["message"]["text"], "as here");
        let second = &run["results"][1];
        assert_eq!(second["level"], "warning");
        let place = &second["locations"][0]["physicalLocation"];
        assert_eq!(
            place,
            &json!({ "artifactLocation": { "uri": "file:///a/b.glb" } })
        );
    }
}
