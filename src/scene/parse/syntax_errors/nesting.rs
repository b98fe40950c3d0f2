//! Finds where a text nests too deeply: brackets inside each other, or a key of very many parts.

use std::ops::Range;

/// Largest depth that is allowed; the parser itself gives up a little deeper.
const MOST: usize = 64;

/// The first bracket or key that is too deep.
pub fn first(text: &str) -> Option<Range<usize>> {
    let (mut depth, mut parts, mut key) = (0_usize, 0, 0);
    let mut chars = text.char_indices();
    while let Some((at, c)) = chars.next() {
        match c {
            '#' => {
                chars.by_ref().find(|(_, c)| *c == '\n');
                (parts, key) = (0, at + 1);
            }
            '"' | '\'' => {
                let mut is_escaped = false;
                chars.by_ref().find(|(_, next)| {
                    let ends = *next == c && !is_escaped;
                    is_escaped = c == '"' && *next == '\\' && !is_escaped;
                    ends
                });
            }
            '[' | '{' => {
                depth += 1;
                if depth > MOST {
                    return Some(at..at + 1);
                }
                (parts, key) = (0, at + 1);
            }
            ']' | '}' => depth = depth.saturating_sub(1),
            '.' => {
                parts += 1;
                if parts > MOST {
                    let start = text[key..].find(|c: char| !c.is_whitespace());
                    return Some(key + start.unwrap_or(0)..at);
                }
            }
            '\n' | '=' | ',' => (parts, key) = (0, at + 1),
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_first_place_that_is_nested_too_deeply() {
        let long = "a.".repeat(400_000);
        let text = format!("# {long}\nx = \"{long}\" # [[[\n\n  {long}b = 1\n");
        let found = first(&text).expect("too deep");
        assert_eq!(text[..found.start].lines().count(), 4);
        assert!(text[found].starts_with("a.a"));
        let nested = format!("x = [1.5, 2.5]\ny = {}", "[".repeat(100));
        assert_eq!(first(&nested), Some(83..84));
        assert_eq!(first("x = [1.5, 2.5]\n[a.b]\n"), None);
    }
}
