//! Diagnostics for machines: one flat JSON object each, with places resolved to lines and columns.

use serde_json::{Map, Value, json};

use super::{Diagnostic, Severity, Span};

impl Diagnostic {
    /// The message as a JSON object: `severity`, `name`, `message`, and where known `help`, `path`,
    /// `line`, `column`, `end_line`, `end_column` (from 1, in characters, the end exclusive) and
    /// `related` (the same place keys and a `message`).
    pub fn to_json(&self) -> Value {
        let mut object = place(&self.span);
        if let Some(file) = &self.file {
            object.insert("path".into(), file.display().to_string().into());
        }
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        object.insert("severity".into(), severity.into());
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
    let (start, end) = (source.place(span.range.start), source.place(span.range.end));
    let object = json!({
        "path": source.path.display().to_string(),
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
