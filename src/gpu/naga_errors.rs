//! Conversion of naga errors to errors at lines of shader source files.

use std::error::Error;

use naga::{Span, WithSpan, front::wgsl, valid::ValidationError};

use super::shader::{ShaderError, ShaderSource};

/// Error for text that does not parse as WGSL.
pub fn parse_error(source: &ShaderSource, error: &wgsl::ParseError) -> ShaderError {
    let mut placed = at_first_place(source, error.message(), error.labels());
    placed.notes.extend(error.notes().map(str::to_owned));
    placed
}

/// Error for WGSL that does not validate.
pub fn validation_error(source: &ShaderSource, error: &WithSpan<ValidationError>) -> ShaderError {
    let mut message = error.as_inner().to_string();
    let mut cause = error.as_inner().source();
    while let Some(inner) = cause {
        message = format!("{message}: {inner}");
        cause = inner.source();
    }
    let labels = error.spans().map(|(span, label)| (*span, label.as_str()));
    at_first_place(source, &message, labels)
}

/// Error with naga's labels: the first label with a location gives the error's location, the others become notes.
fn at_first_place<'a>(
    source: &ShaderSource,
    message: &str,
    labels: impl Iterator<Item = (Span, &'a str)>,
) -> ShaderError {
    let mut error = ShaderError::new(&source.file, message);
    for (span, label) in labels {
        let place = span.to_range().and_then(|range| source.locate(range));
        let label = label.trim();
        match place {
            Some(place) if error.location.is_none() => {
                error.location = Some(place);
                if !label.is_empty() && !message.contains(label) {
                    error.notes.push(label.to_owned());
                }
            }
            Some(at) => {
                let at = format!("{}:{}:{}", at.file, at.line, at.column);
                error.notes.push(format!("{label} ({at})"));
            }
            None if label.is_empty() => {}
            None => error.notes.push(label.to_owned()),
        }
    }
    error
}
