//! Finds a bracket that is never closed: most messages about the lines below only follow from that.

use crate::syntax::{Token, TokenKind, tokens};

/// A bracket without its partner.
#[derive(Debug, PartialEq, Eq)]
pub struct Unclosed {
    /// Byte offset of the bracket.
    pub at: usize,
    /// The bracket that would close it.
    pub closer: char,
    /// Byte offset of the end of the text that can be inside the brackets.
    pub end: usize,
    /// Closing bracket of another kind that comes next, if it is what shows that this one is not closed.
    pub before: Option<char>,
}

/// The innermost bracket that is still open at a line that cannot be inside it, or where an outer bracket
/// is closed.
pub fn first(text: &str) -> Option<Unclosed> {
    let mut open: Vec<(char, usize)> = Vec::new();
    // First character of the last token that is neither space nor comment, and the byte offset of its end.
    let mut last = ('\n', 0);
    let (mut line_start, mut in_header) = (true, false);
    for Token { kind, at } in tokens(text) {
        if line_start {
            let line = text[at.start..].lines().next().unwrap_or("").trim();
            if let Some((bracket, start)) = open.last()
                && cannot_be_inside(line, *bracket, last.0)
            {
                return Some(unclosed(*bracket, *start, last.1, None));
            }
            in_header = open.is_empty() && line.starts_with('[');
        }
        line_start = kind == TokenKind::Newline;
        let is_said = !matches!(
            kind,
            TokenKind::Newline | TokenKind::Whitespace | TokenKind::Comment
        );
        let Some(c) = text[at.start..]
            .chars()
            .next()
            .filter(|_| is_said && !in_header)
        else {
            continue;
        };
        match (c, open.last()) {
            ('[' | '{', _) => open.push((c, at.start)),
            (']' | '}', Some((bracket, start))) => {
                let is_around = |(bracket, _): &(char, usize)| closer(*bracket) == c;
                if closer(*bracket) != c && open.iter().any(is_around) {
                    return Some(unclosed(*bracket, *start, last.1, Some(c)));
                }
                open.pop();
            }
            // The text is not closed on its line, and the bracket only seems open.
            ('"' | '\'', _)
                if !text[..at.end].ends_with(c) && text[at.end..].starts_with(['\r', '\n']) =>
            {
                return None;
            }
            _ => {}
        }
        last = (c, at.end);
    }
    open.last()
        .map(|(bracket, start)| unclosed(*bracket, *start, last.1, None))
}

fn unclosed(bracket: char, at: usize, end: usize, before: Option<char>) -> Unclosed {
    Unclosed {
        at,
        closer: closer(bracket),
        end,
        before,
    }
}

fn closer(bracket: char) -> char {
    if bracket == '{' { '}' } else { ']' }
}

/// Whether a line shows that the bracket must have been closed before; `last` is the last character
/// before the line that is neither space nor comment.
fn cannot_be_inside(line: &str, bracket: char, last: char) -> bool {
    let is_name = |c: char| c.is_alphanumeric() || "_-.\"'* ".contains(c);
    let bare = line.split('#').next().unwrap_or("").trim_end();
    let header = bare.trim_start_matches('[').trim_end_matches(']');
    let is_header = bare.starts_with('[')
        && bare.ends_with(']')
        && header.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && header.chars().all(is_name)
        && !["true", "false", "inf", "nan"].contains(&header);
    let key = line.split('=').next().unwrap_or("").trim();
    let is_key = line.contains('=')
        && key.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && key.chars().all(is_name);
    let follows_comma = matches!(last, ',' | '{');
    is_header || is_key && (bracket == '[' || !follows_comma)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Option<(&str, char)> {
        let open = first(text)?;
        Some((&text[open.at..open.end], open.closer))
    }

    #[test]
    fn finds_the_bracket_that_is_not_closed() {
        for (text, want) in [
            ("a = { b = 1 # {\n[c]\nd = 1\n", ("{ b = 1", '}')),
            ("a = { b = [1, 2\nc = 1\n", ("[1, 2", ']')),
            (
                "[x]\na = { b = 1,\n  c = 2\nd = 3\n",
                ("{ b = 1,\n  c = 2", '}'),
            ),
            ("a = [[1, 2], [3\n[[instance]]\n", ("[3", ']')),
            ("a = [1,\n 2,\n", ("[1,\n 2,", ']')),
            ("a = { b = [1, 2 }\nc = 1\n", ("[1, 2", ']')),
            ("a = [{ b = 1, { c = 2 }]\n", ("{ b = 1, { c = 2 }", '}')),
        ] {
            assert_eq!(found(text), Some(want), "{text}");
        }
    }

    #[test]
    fn closed_brackets_are_left_alone() {
        for text in [
            "a = { b = \"{\", c = '[', # {\n}\n[d]\n",
            "a = [\n  [1, 2],\n  [3, 4] # [\n]\nb = 1\n",
            "a = { b = 1,\n  c = 2 }\n[[d]]\ne = \"\"\"\n[f\n\"\"\"\n",
            "a = { b = 1, # one\n  c = 2 }\n",
            "[a\"b\n",
            "a = [1, 2}\n",
        ] {
            assert_eq!(first(text), None, "{text}");
        }
    }
}
