//! Search for the brace that is never closed, since Rhai points at the end of the script, or at the next
//! function.

use rhai::ParseErrorType;

use crate::script::tokens::{Token, tokens};

/// A `{` without its `}`.
#[derive(Debug, PartialEq, Eq)]
pub struct Unclosed {
    /// Offset of the `{`, bytes.
    pub at: usize,
    /// Offset of the last token that can be inside of the braces, bytes.
    pub last: usize,
}

/// Unclosed brace that a syntax error may follow from, if there is one.
pub fn explains(wrong: &ParseErrorType, text: &str) -> Option<Unclosed> {
    let may = matches!(
        wrong,
        ParseErrorType::MissingToken(..)
            | ParseErrorType::UnexpectedEOF
            | ParseErrorType::WrongFnDefinition
    );
    may.then(|| first(text)).flatten()
}

/// Innermost brace that is still open where the indentation, or the start of a function, shows that it should
/// be closed; else the innermost one that is open at the end.
fn first(text: &str) -> Option<Unclosed> {
    let tokens = tokens(text);
    let count = |sign: fn(&&Token) -> bool| tokens.iter().filter(sign).count();
    if count(|t| opens(t)) <= count(|t| t.text == "}") {
        return None;
    }
    // Open braces, each with the indentation of its line.
    let mut open: Vec<(&Token, &str)> = Vec::new();
    let mut before: Option<&Token> = None;
    let mut here = "";
    for token in &tokens {
        let from = before.map_or(0, |before| before.at.start);
        let breaks = text[from..token.at.start].rfind('\n');
        let is_first = breaks.is_some() || before.is_none();
        if is_first {
            let lead = &text[from + breaks.map_or(0, |i| i + 1)..token.at.start];
            here = &lead[..lead.len() - lead.trim_start().len()];
        }
        let is_over = match (token.text, open.as_slice()) {
            ("}", [.., (_, outer), (_, inner)]) => is_first && *inner != here && *outer == here,
            ("fn" | "private", [..]) => true,
            _ => false,
        };
        if is_over && let Some((inner, _)) = open.last() {
            return Some(unclosed(inner, before));
        }
        if opens(token) {
            open.push((token, here));
        } else if token.text == "}" {
            open.pop();
        }
        before = Some(token);
    }
    open.last().map(|(inner, _)| unclosed(inner, before))
}

fn unclosed(open: &Token, last: Option<&Token>) -> Unclosed {
    Unclosed {
        at: open.at.end - 1, // the brace of `#{` too
        last: last.map_or(0, |token| token.at.start),
    }
}

fn opens(token: &Token) -> bool {
    matches!(token.text, "{" | "#{")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_brace_that_is_not_closed() {
        for (text, open, last) in [
            ("fn a() {", 1, 1),
            (
                "fn a() {\n    if b {\n        c();\n}\n\nfn d() { }\n",
                2,
                3,
            ),
            ("fn a() {\n    if b { c(); }\n\nfn d() { }\n", 1, 2),
            ("fn a() {\n    #{\n        b: 1,\n}\n// }\n", 2, 3),
            ("fn a() {\n    b(\"}\");\n    if c {\n        d();\n", 3, 4),
        ] {
            let found = first(text).map(|found| {
                let line = |at: usize| 1 + text[..at].matches('\n').count();
                (line(found.at), line(found.last))
            });
            assert_eq!(found, Some((open, last)), "{text}");
        }
        for text in ["fn a() { fn b() { } }", "fn a() { \"{\" } // {", "}", ""] {
            assert_eq!(first(text), None, "{text}");
        }
    }
}
