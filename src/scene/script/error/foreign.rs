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
    // A form is near the place, and expressions would look through megabytes of a line for seconds.
    let line = line.max(text.ceil_char_boundary(start.saturating_sub(1000)));
    let after = text[start..].lines().next()?;
    let (before, after) = (
        &text[line..start],
        &after[..after.floor_char_boundary(1000)],
    );
    let (message, help) = forms::explained("syntax", &format!("{message}\n{before}¦{after}"))?;
    Some((message, Some(help)))
}
