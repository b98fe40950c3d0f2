//! Diagnostics for machines: one flat JSON object each, with spans resolved to lines and columns.

use serde_json::{Map, Value, json};

use super::{Diagnostic, Span};

impl Diagnostic {
    /// The message as a JSON object: `severity`, `name`, `message`, and if known `help`, `path`, `line`,
    /// `column`, `end_line`, `end_column` (from 1, in characters, the end exclusive) and `related` (the same
    /// keys for a place, and a `message`).
    pub fn to_json(&self) -> Value {
        let mut object = place(&self.span);
        if let Some(file) = &self.file {
            object.insert("path".into(), file.display().to_string().into());
        }
        object.insert("severity".into(), self.severity.name().into());
        object.insert("name".into(), self.name.into());
        object.insert("message".into(), self.message.as_str().into());
        if let Some(help) = &self.help {
            object.insert("help".into(), help.as_str().into());
        }
        if let Some((span, note)) = &self.related {
            let mut related = place(span);
            related.insert("message".into(), note.as_str().into());
            object.insert("related".into(), Value::Object(related));
        }
        Value::Object(object)
    }
}

fn place(span: &Span) -> Map<String, Value> {
    let Some(source) = &span.source else {
        return Map::new();
    };
    let path = source.path.display().to_string();
    if source.generated {
        return Map::from_iter([("path".to_owned(), path.into())]);
    }
    let (start, end) = (source.place(span.range.start), source.place(span.range.end));
    let object = json!({
        "path": path,
        "line": start.line,
        "column": start.column,
        "end_line": end.line,
        "end_column": end.column,
    });
    match object {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::diagnostic::Source;

    #[test]
    fn places_are_lines_and_characters() {
        let text = "é = 1\n\tkey = [1,\n2]\n".to_owned();
        let source = Arc::new(Source::new("a.toml", text));
        let span = |range| Span {
            source: Some(Arc::clone(&source)),
            range,
        };
        let message = Diagnostic::new("wrong-length", span(14..20), "too short")
            .help("add one")
            .related(span(0..2), "like this one");
        let want = json!({
            "severity": "error",
            "name": "wrong-length",
            "message": "too short",
            "help": "add one",
            "path": "a.toml",
            "line": 2,
            "column": 8,
            "end_line": 3,
            "end_column": 3,
            "related": {
                "message": "like this one",
                "path": "a.toml",
                "line": 1,
                "column": 1,
                "end_line": 1,
                "end_column": 2,
            },
        });
        assert_eq!(message.to_json(), want);
    }

    #[test]
    fn a_file_without_text_has_a_path_only() {
        let message = Diagnostic::in_file("broken-file", "a.glb".as_ref(), "cut short").warning();
        let want = json!({
            "severity": "warning",
            "name": "broken-file",
            "message": "cut short",
            "path": "a.glb",
        });
        assert_eq!(message.to_json(), want);
    }
}
