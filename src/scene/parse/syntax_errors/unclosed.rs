//! Finds a bracket that is never closed: most messages about the lines below only follow from that.

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
    // The last character that is neither space nor comment, and the byte offset of its end.
    let mut last = ('\n', 0);
    let mut at = 0;
    let mut line_start = true;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        if line_start {
            let line = rest.lines().next().unwrap_or("");
            if let Some((bracket, start)) = open.last()
                && cannot_be_inside(line.trim(), *bracket, last.0)
            {
                return Some(unclosed(*bracket, *start, last.1, None));
            }
            if open.is_empty() && line.trim_start().starts_with('[') {
                at += line.len(); // table header
                line_start = false;
                continue;
            }
        }
        line_start = c == '\n';
        at += match c {
            '#' => rest.find('\n').unwrap_or(rest.len()),
            '"' | '\'' => {
                last = (c, at + 1);
                let length = length_of_text(rest, c);
                if rest[length..].starts_with('\n') && !rest[..length].ends_with(c) {
                    return None; // the text is not closed, and the bracket only seems open
                }
                length
            }
            _ => {
                match (c, open.last()) {
                    ('[' | '{', _) => open.push((c, at)),
                    (']' | '}', Some((bracket, start))) => {
                        let is_around = |(bracket, _): &(char, usize)| closer(*bracket) == c;
                        if closer(*bracket) != c && open.iter().any(is_around) {
                            return Some(unclosed(*bracket, *start, last.1, Some(c)));
                        }
                        open.pop();
                    }
                    _ => {}
                }
                if !c.is_whitespace() {
                    last = (c, at + c.len_utf8());
                }
                c.len_utf8()
            }
        };
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

/// Length of a text in quotes, with them; without a closing quote it ends with its line.
fn length_of_text(rest: &str, quote: char) -> usize {
    let triple = if quote == '"' { "\"\"\"" } else { "'''" };
    if let Some(inner) = rest.strip_prefix(triple) {
        return inner.find(triple).map_or(rest.len(), |end| end + 6);
    }
    let mut is_escaped = false;
    for (i, c) in rest.char_indices().skip(1) {
        match c {
            '\n' => return i,
            c if c == quote && !is_escaped => return i + 1,
            _ => is_escaped = c == '\\' && quote == '"' && !is_escaped,
        }
    }
    rest.len()
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
