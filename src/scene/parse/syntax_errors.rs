//! Syntax errors of a text as messages, and the parts of the text that they make doubtful.

mod numbers;
mod plain_words;
mod several;
mod unclosed;
mod value_types;

use std::{ops::Range, sync::Arc};

use self::unclosed::Unclosed;
use crate::{
    diagnostic::{Diagnostic, Source, Span},
    forms,
    parse::tables::is_project,
    suggest,
    syntax::{Entries, MOST_TABLES, TOO_MANY_TABLES, Token, TokenKind, tokens},
    table::report::Report,
};

pub use plain_words::in_plain_words;

/// The part of a file that a syntax error makes doubtful: other messages about it may only follow from
/// that error.
pub struct Shadow {
    /// The file.
    source: Option<Arc<Source>>,
    /// Byte range from the header of the table that the error is in, to the next header.
    table: Range<usize>,
    /// Byte offset of the line with the error.
    line: usize,
}

impl Shadow {
    /// Whether a message may only follow from the syntax error.
    pub fn hides(&self, message: &Diagnostic) -> bool {
        let at = message.span.range.start;
        let in_file = match (&message.span.source, &self.source) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, _) => a.is_none(),
        };
        let syntax = matches!(
            message.name,
            "toml-syntax" | "duplicate-key" | "too-deep" | "scene-too-large"
        );
        let doubtful = match message.name {
            // A missing key may stand on the broken line.
            "missing-key" => self.table.contains(&at),
            _ => (self.line..self.table.end).contains(&at),
        };
        in_file && !syntax && doubtful
    }
}

/// Entries of a text as far as they can be understood, at their positions in the report, which gets the
/// errors.
pub fn tree(source: &Arc<Source>, report: &mut Report) -> (Entries, Vec<Shadow>) {
    let base = report.start_of(source);
    let shadows = errors(source, base, report);
    (report.tree_of(source), shadows)
}

/// Reports the errors of a text that begins at `base` in the report.
fn errors(source: &Arc<Source>, base: usize, report: &mut Report) -> Vec<Shadow> {
    let (text, errors) = (source.text.as_str(), source.syntax().errors());
    let shadow = |table, line| Shadow {
        source: Some(Arc::clone(source)),
        table,
        line,
    };
    let mut shadows: Vec<Shadow> = Vec::new();
    if let Some((at, language, help)) = foreign_language(text).filter(|_| !errors.is_empty()) {
        let message = format!(
            "this is {language}, and scenes are written in TOML, beginning with `version = 1`"
        );
        let moved = base + at.start..base + at.end;
        report.error("toml-syntax", &moved, message).help = Some(help.to_owned());
        return vec![shadow(0..text.len() + 1, 0)];
    }
    let mut line_end = None;
    let is_wrong = !errors.is_empty();
    let unclosed = is_wrong.then(|| unclosed::first(text)).flatten();
    let (mut doubled, mut is_full) = (0..0, false);
    for error in errors {
        let at = error.at.clone();
        if unclosed.as_ref().is_some_and(|open| at.start >= open.at) || doubled.contains(&at.start)
        {
            continue; // it follows from the unclosed bracket or the doubled header
        }
        // A broken line gives one message, the first; a duplicate key is not a syntax error.
        let same_line = line_end.is_some_and(|end| at.start <= end);
        if same_line && error.message != "duplicate key" {
            continue;
        }
        let start = text.floor_char_boundary(at.start);
        line_end = Some(text[start..].find('\n').map_or(text.len(), |i| start + i));
        if report.is_full() {
            report.error("toml-syntax", &at, ""); // only counted
            is_full = true;
            continue;
        }
        explain(source, base, at.clone(), &error.message, report);
        let line = text[..start].rfind('\n').map_or(0, |i| i + 1);
        if error.message == "duplicate key" {
            doubled = body_of_header(text, start);
        } else if error
            .message
            .starts_with("invalid basic string, expected `\"`")
        {
            doubled = at.start + 1..table_around(text, line).end; // lines of the text that is not closed
        } else if text[start..].starts_with("/*") {
            doubled = start + 1
                ..text[start..]
                    .find("*/")
                    .map_or(text.len(), |end| start + end + 2);
        }
        shadows.push(shadow(table_around(text, line), line));
    }
    if is_full {
        shadows.push(shadow(0..text.len() + 1, 0));
    }
    if let Some(open) = unclosed.filter(|_| !report.is_full()) {
        explain_unclosed(text, base, &open, report);
        let line = text[..open.at].rfind('\n').map_or(0, |i| i + 1);
        let table = table_around(text, line).start..text.len() + 1;
        shadows.push(shadow(table, line));
    }
    shadows
}

fn explain_unclosed(text: &str, base: usize, open: &Unclosed, report: &mut Report) {
    let line = begin_of(text[open.at..].lines().next().unwrap_or_default());
    if let Some((at, message, help)) = forms::found("open", line) {
        let at = base + open.at + at.start..base + open.at + at.end;
        report.error("toml-syntax", &at, message).help = Some(help);
        return;
    }
    let message = format!("`{}` is not closed", &text[open.at..=open.at]);
    let line = 1 + text[..open.end].matches('\n').count();
    let place = match open.before {
        Some(other) => format!("before the `{other}`"),
        None => "such as at the end".to_owned(),
    };
    let at = base + open.at..base + open.at + 1;
    report.error("toml-syntax", &at, message).help =
        Some(format!("add `{}`, {place} of line {line}", open.closer));
}

/// Byte range of the lines below a header, for the position of a name in it; else empty.
fn body_of_header(text: &str, at: usize) -> Range<usize> {
    let line = text[..at].rfind('\n').map_or(0, |i| i + 1);
    if !text[line..at].trim_start().starts_with('[') {
        return 0..0;
    }
    let table = table_around(text, line);
    at + 1..table.end
}

fn explain(source: &Source, base: usize, at: Range<usize>, message: &str, report: &mut Report) {
    let text = source.text.as_str();
    let moved = |range: &Range<usize>| base + range.start..base + range.end;
    if message == "duplicate key" {
        let key = text.get(at.clone()).unwrap_or("");
        let message = format!("{} is defined twice", suggest::key(key));
        let first = first_place(text, &at).map(|range| report.span(&moved(&range)));
        let error = report.error("duplicate-key", &moved(&at), message);
        error.help = Some(match key {
            "instance" => "write `[[instance]]`, with two brackets on each side, for each".into(),
            _ => "move what is in one of the two into the other, or give it another name".into(),
        });
        error.related = first.map(|span: Span| (span, "it is first defined here".into()));
    } else if message == TOO_MANY_TABLES {
        let message = format!("the text has more than {MOST_TABLES} tables");
        report.error("scene-too-large", &moved(&at), message).help =
            Some("geometry belongs in glTF files, named by `file`".into());
    } else if message.contains("recurs") {
        let message = "arrays and tables are nested too deeply";
        // The parser does not say where.
        let at = first_too_deep(text).unwrap_or(at);
        report.error("too-deep", &moved(&at), message).help =
            Some("a scene needs four levels".into());
    } else {
        let words = in_plain_words(text, &at, message, is_project(&source.path));
        let at = moved(&words.at.unwrap_or(at));
        report.error("toml-syntax", &at, words.message).help = words.help;
    }
}

/// The earlier line that has the same header, the same key under the same header, or the header's table as a dotted
/// key before all headers.
fn first_place(text: &str, at: &Range<usize>) -> Option<Range<usize>> {
    let line_start = text[..at.start].rfind('\n').map_or(0, |i| i + 1);
    let key = text.get(at.clone())?;
    let line = text[line_start..].lines().next()?.trim_start();
    let header = |line: &str| -> String {
        let inside = line.split_inclusive(']').next().unwrap_or("");
        inside.chars().filter(|c| !c.is_whitespace()).collect()
    };
    let dotted = header(line).replace(['[', ']'], "");
    let mut end = line_start;
    for earlier in text[..line_start].split_inclusive('\n').rev() {
        let start = end - earlier.len();
        end = start;
        let trimmed = earlier.trim_start();
        let indent = start + earlier.len() - trimmed.len();
        let is_header = trimmed.starts_with('[');
        if line.starts_with('[') {
            if is_header && header(trimmed) == header(line) {
                let inside = trimmed.rfind(key)?;
                return Some(indent + inside..indent + inside + key.len());
            }
            if !is_header
                && let Some((path, _)) = trimmed.split_once('=')
                && path
                    .chars()
                    .filter(|c| !c.is_whitespace())
                    .eq(dotted.chars())
            {
                return Some(indent..indent + path.trim_end().len());
            }
        } else if is_header {
            return None;
        } else if let Some(rest) = trimmed.strip_prefix(key)
            && rest.trim_start().starts_with(['=', '.'])
        {
            return Some(indent..indent + key.len());
        }
    }
    None
}

/// Byte range from the last header at or before the line to the next one after it.
fn table_around(text: &str, line: usize) -> Range<usize> {
    let is_header = |at: &usize| text[*at..].trim_start_matches([' ', '\t']).starts_with('[');
    let starts = |part: &str, base: usize| -> Vec<usize> {
        part.match_indices('\n')
            .map(|(i, _)| base + i + 1)
            .collect()
    };
    let mut before = starts(&text[..line], 0);
    before.insert(0, 0);
    let first = before.into_iter().rev().find(is_header).unwrap_or(0);
    let last = starts(&text[line..], line).into_iter().find(is_header);
    first..last.unwrap_or(text.len() + 1)
}

/// Largest depth that is allowed; the parser itself gives up a little deeper.
const MOST_DEPTH: usize = 64;

/// The first bracket or key that is too deep.
fn first_too_deep(text: &str) -> Option<Range<usize>> {
    let (mut depth, mut parts, mut key) = (0_usize, 0, None);
    for Token { kind, at } in tokens(text) {
        match kind {
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => {
                depth += 1;
                if depth > MOST_DEPTH {
                    return Some(at);
                }
                (parts, key) = (0, None);
            }
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                depth = depth.saturating_sub(1);
            }
            TokenKind::Dot => {
                parts += 1;
                if parts > MOST_DEPTH {
                    return Some(key.unwrap_or(at.start)..at.start);
                }
            }
            TokenKind::Equals | TokenKind::Comma | TokenKind::Newline => (parts, key) = (0, None),
            TokenKind::Whitespace | TokenKind::Comment => {}
            _ => key = key.or(Some(at.start)),
        }
    }
    None
}

/// A message and advice on what to do.
pub struct Words {
    pub message: String,
    pub help: Option<String>,
    /// Place of the mistake in its line without indent, if the parser points elsewhere.
    pub at: Option<Range<usize>>,
}

/// A syntax error with the text around it.
struct Mistake<'t> {
    /// Text that the parser points at.
    pub found: &'t str,
    /// Text from there to the end of the line.
    pub rest: &'t str,
    /// Text of the line around the place, without spaces around it.
    pub line: &'t str,
    /// Whether that text begins with the line.
    pub is_from_start: bool,
    /// Kind of the table that the line is in; empty before all headers.
    pub table: &'t str,
    /// Text left of the first `=`; `value` is the text right of it, without a comment.
    pub key: &'t str,
    pub value: &'t str,
    /// The parser's message.
    pub message: &'t str,
    /// Whether the text is a project's, not a scene's.
    pub is_project: bool,
}

/// Number of bytes of a line that expressions look through on each side of a mistake.
const MOST_READ: usize = 2000;

/// The first [`MOST_READ`] bytes of a text, up to a character.
fn begin_of(text: &str) -> &str {
    &text[..text.floor_char_boundary(MOST_READ)]
}

/// A message with advice.
fn words(message: impl Into<String>, help: impl Into<String>) -> Option<Words> {
    Some(Words {
        message: message.into(),
        help: Some(help.into()),
        at: None,
    })
}

/// Whether a text is a number without letters.
fn is_number(text: &str) -> bool {
    !text.is_empty() && text.parse::<f64>().is_ok() && !text.contains(char::is_alphabetic)
}

/// Place of the first line that says something, the language of a text that is not TOML, and advice.
fn foreign_language(text: &str) -> Option<(Range<usize>, &'static str, &'static str)> {
    let is_remark = |line: &str| {
        let line = line.trim();
        let is_hash = line.starts_with("# ") || line == "#";
        line.is_empty() || is_hash || line.starts_with("//")
    };
    let mut lines = text.lines().filter(|line| !is_remark(line));
    let (first, next) = (
        begin_of(lines.next()?),
        begin_of(lines.next().unwrap_or_default()).trim(),
    );
    let start = first.as_ptr() as usize - text.as_ptr() as usize;
    let indent = first.len() - first.trim_start().len();
    let at = start + indent..start + first.trim_end().len();
    let first = first.trim();
    let mut begin = format!("{first}\n{next}");
    for spaced in [" {", "{ ", "{\n"] {
        begin = begin.replace(spaced, "{");
    }
    if is_entry(first) && (next.is_empty() || is_entry(next) || next.starts_with("- ")) {
        "---\n".clone_into(&mut begin);
    }
    let (name, help) = suggest::language(&begin)?;
    Some((at, name, help))
}

/// Whether a line is an entry of YAML, such as `roughness: 0.5`.
fn is_entry(line: &str) -> bool {
    line.split_once(':').is_some_and(|(key, rest)| {
        let is_key = key.chars().all(|c| c.is_alphanumeric() || "_-".contains(c));
        is_key && !key.is_empty() && (rest.is_empty() || rest.starts_with(' '))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_first_place_that_is_nested_too_deeply() {
        let long = "a.".repeat(400_000);
        let text = format!("# {long}\nx = \"{long}\" # [[[\n\n  {long}b = 1\n");
        let found = first_too_deep(&text).expect("too deep");
        assert_eq!(text[..found.start].lines().count(), 4);
        assert!(text[found].starts_with("a.a"));
        let nested = format!("x = [1.5, 2.5]\ny = {}", "[".repeat(100));
        assert_eq!(first_too_deep(&nested), Some(83..84));
        assert_eq!(first_too_deep("x = [1.5, 2.5]\n[a.b]\n"), None);
    }
}
