//! Formatting of scene text and projects: spaces, indentation of lists and empty lines. Line breaks, comments and
//! values stay, since a list on one line is a vector, and one on several lines is a table of its own.

use serde_json::{Value, json};

use super::position::range;
use reflet_scene::syntax::{
    Token,
    TokenKind::{self, *},
    tokens,
};

/// Most empty lines in a row.
const MOST_EMPTY: usize = 2;
/// Most spaces of an indentation step.
const MOST_SPACES: u64 = 16;

/// Edits that format a text: one of the whole text, none where nothing changes or the text is no TOML.
pub fn edits(text: &str, options: &Value) -> Vec<Value> {
    let Ok(values) = toml::from_str::<toml::Table>(text) else {
        return Vec::new();
    };
    let spaces = options["tabSize"].as_u64().unwrap_or(4).min(MOST_SPACES) as usize;
    let step = match options["insertSpaces"] == false {
        true => "\t".to_owned(),
        false => " ".repeat(spaces),
    };
    let formatted = formatted(text, &step);
    // Formatting must never change what a text says.
    let is_same = toml::from_str::<toml::Table>(&formatted).is_ok_and(|new| new == values);
    match is_same && formatted != text {
        true => vec![json!({ "range": range(text, &(0..text.len())), "newText": formatted })],
        false => Vec::new(),
    }
}

/// A text with `step` as the indentation inside of brackets.
fn formatted(text: &str, step: &str) -> String {
    let tokens = tokens(text);
    let end = if text.contains("\r\n") { "\r\n" } else { "\n" };
    let mut new = String::new();
    // Indentation of the line of each open bracket: several brackets opened on one line indent their content once.
    let mut open: Vec<usize> = Vec::new();
    let mut empty = 0;
    for line in tokens.split_inclusive(|token| token.kind == Newline) {
        let is_white = |token: &&Token| !matches!(token.kind, Whitespace | Newline | Eof);
        let parts: Vec<&Token> = line.iter().filter(is_white).collect();
        let Some(first) = parts.first() else {
            empty += 1;
            continue;
        };
        if !new.is_empty() {
            new.push_str(&end.repeat(empty.min(MOST_EMPTY)));
        }
        empty = 0;
        let closing = parts.iter().take_while(|part| closes(part.kind)).count();
        let indentation = match closing {
            0 => open.last().map_or(0, |outer| outer + 1),
            _ => open.iter().rev().nth(closing - 1).copied().unwrap_or(0),
        };
        new.push_str(&step.repeat(indentation));
        let is_header = open.is_empty() && first.kind == LeftSquareBracket;
        for (index, part) in parts.iter().enumerate() {
            if let Some(before) = index.checked_sub(1).map(|i| parts[i]) {
                let between = &text[before.at.end..part.at.start];
                new.push_str(gap((before.kind, part.kind), is_header, between));
            }
            new.push_str(&text[part.at.clone()]);
            if closes(part.kind) {
                open.pop();
            } else if opens(part.kind) {
                open.push(indentation);
            }
        }
        new.push_str(end);
    }
    new
}

/// White space between two parts of a line, where `between` stands.
fn gap((before, after): (TokenKind, TokenKind), is_header: bool, between: &str) -> &str {
    match (before, after) {
        // Comments below each other stay aligned.
        (_, Comment) if !between.is_empty() => between,
        (_, Comment) => " ",
        _ if is_header => "",
        (Dot | LeftSquareBracket, _) | (_, Dot | Comma | RightSquareBracket) => "",
        (LeftCurlyBracket, RightCurlyBracket) => "",
        (Equals | Comma | LeftCurlyBracket, _) | (_, Equals | RightCurlyBracket) => " ",
        _ => between,
    }
}

fn opens(kind: TokenKind) -> bool {
    matches!(kind, LeftSquareBracket | LeftCurlyBracket)
}

fn closes(kind: TokenKind) -> bool {
    matches!(kind, RightSquareBracket | RightCurlyBracket)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spaces_are_set_and_everything_else_stays() {
        let text = "\n[ material . brass ]# a\nbase_color=[ 1,0.5 ,0 ]   # aligned\nshape={kind=\"a  b\",at={}}\n\n\n\n\n  x = \
                    '''\n  raw=1\n'''\n[[ instance ]]\npoints=[ # two\n[1,2],\n      [3,4], { a=1 },\n  ]\ndate = 1979-05-27 07:32:00";
        let wanted = "[material.brass] # a\nbase_color = [1, 0.5, 0]   # aligned\nshape = { kind = \"a  b\", at = {} }\n\n\nx = \
                      '''\n  raw=1\n'''\n[[instance]]\npoints = [ # two\n  [1, 2],\n  [3, 4], { a = 1 },\n]\ndate = 1979-05-27 07:32:00\n";
        assert_eq!(formatted(text, "  "), wanted);
        assert_eq!(formatted(wanted, "  "), wanted);
        let windows = |text: &str| text.replace('\n', "\r\n");
        assert_eq!(formatted(&windows(text), "  "), windows(wanted));
        assert_eq!(formatted("", "  "), "");
    }

    #[test]
    fn scenes_keep_their_values_and_their_lines() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
        let files = std::fs::read_dir(folder).expect("a folder");
        let is_scene = |path: &std::path::PathBuf| path.extension().is_some_and(|e| e == "toml");
        let scenes = files.flatten();
        let scenes: Vec<_> = scenes.map(|file| file.path()).filter(is_scene).collect();
        assert!(scenes.len() > 5);
        for path in scenes {
            let text = std::fs::read_to_string(&path).expect("a text");
            let new = formatted(&text, "    ");
            let values = |text: &str| toml::from_str::<toml::Table>(text).expect("TOML");
            assert_eq!(values(&new), values(&text), "{}", path.display());
            for (new, old) in new.lines().zip(text.lines()) {
                assert_eq!(new, old, "{}", path.display());
            }
        }
    }
}
