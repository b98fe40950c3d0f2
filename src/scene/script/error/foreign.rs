//! Syntax of other languages, and its counterpart in Rhai.

use crate::{diagnostic::Span, forms, suggest};

/// Message and advice about a word of another language.
pub fn word(word: &str) -> Option<(String, Option<String>)> {
    let help = suggest::in_script("words", word)?;
    let message = format!("there is no {} in Rhai", suggest::key(word));
    Some((message, Some(help.to_owned())))
}

/// Message and advice about a sign of another language, by the text around the place of a syntax error and by Rhai's
/// message.
pub fn sign(at: &Span, message: &str) -> Option<(String, Option<String>)> {
    let text = &at.source.as_ref()?.text;
    let start = at.range.start;
    let line = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let (before, after) = (&text[line..start], text[start..].lines().next()?);
    let (message, help) = forms::explained("syntax", &format!("{message}\n{before}¦{after}"))?;
    Some((message, Some(help)))
}
