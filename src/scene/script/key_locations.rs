//! Place of a map's key in the text of a script.

use std::sync::Arc;

use super::tokens::tokens;
use crate::diagnostic::Span;

/// Place of a key in a map that is an argument of a call; `call` is the span of the name that is called.
pub fn key_of_call(call: &Span, key: &str) -> Option<Span> {
    let source = call.source.as_ref()?;
    let start = call.range.end;
    let tokens = tokens(source.text.get(start..)?);
    let mut open = Vec::new();
    for (token, next) in tokens.iter().zip(tokens.iter().skip(1)) {
        match token.text {
            "(" | "[" | "{" | "#{" => open.push(token.text),
            ")" | "]" | "}" => {
                open.pop();
                if open.is_empty() {
                    return None;
                }
            }
            text if open == ["(", "#{"] && next.text == ":" => {
                let inner = text.trim_matches(['"', '`', '\'']);
                if inner == key {
                    return Some(Span {
                        source: Some(Arc::clone(source)),
                        range: start + token.at.start..start + token.at.end,
                    });
                }
            }
            _ => {}
        }
    }
    None
}
