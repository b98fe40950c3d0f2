//! Place of a map's key in the text of a script.

use std::sync::Arc;

use crate::diagnostic::Span;

/// Place of a key in a map that is an argument of a call; `call` is the span of the name that is called.
pub fn key_of_call(call: &Span, key: &str) -> Option<Span> {
    let source = call.source.as_ref()?;
    let mut open = Vec::new();
    let mut at = call.range.end;
    while let Some(c) = source.text.get(at..)?.chars().next() {
        let rest = &source.text[at..];
        let skipped = match c {
            '"' | '`' | '\'' => {
                let end = end_of_text(&rest[1..], c)?;
                let is_key = rest[1..].get(..end) == Some(key)
                    && rest[end + 2..].trim_start().starts_with(':');
                if is_key && open == ['(', '{'] {
                    let range = at..at + end + 2;
                    return Some(Span {
                        source: Some(Arc::clone(source)),
                        range,
                    });
                }
                end + 2
            }
            '/' if rest.starts_with("//") => rest.find('\n')?,
            '/' if rest.starts_with("/*") => rest.find("*/")? + 2,
            '(' | '[' | '{' => {
                open.push(c);
                1
            }
            ')' | ']' | '}' => {
                open.pop();
                if open.is_empty() {
                    return None;
                }
                1
            }
            c if c.is_alphanumeric() || c == '_' => {
                let is_name = |c: char| c.is_alphanumeric() || c == '_';
                let word = rest.split(|c| !is_name(c)).next().unwrap_or_default();
                let is_key = word == key && rest[word.len()..].trim_start().starts_with(':');
                if is_key && open == ['(', '{'] {
                    let range = at..at + word.len();
                    return Some(Span {
                        source: Some(Arc::clone(source)),
                        range,
                    });
                }
                word.len()
            }
            c => c.len_utf8(),
        };
        at += skipped;
    }
    None
}

/// Index of the quote that closes a text.
fn end_of_text(text: &str, quote: char) -> Option<usize> {
    let mut is_escaped = false;
    let mut chars = text.char_indices();
    chars.find_map(|(i, c)| {
        if c == quote && !is_escaped {
            return Some(i);
        }
        is_escaped = c == '\\' && !is_escaped && quote != '`';
        None
    })
}
