//! Diagnostics for people: the message, the source line with carets under the place, and the help.

use std::fmt::{self, Display, Write as _};

use anstyle::{AnsiColor, Style};
use unicode_width::UnicodeWidthChar;

use super::{Diagnostic, Severity, Span};

/// Columns that a tab advances to a multiple of; shown as spaces so that carets line up.
const TAB: usize = 4;
/// Widest part of a source line that is shown, columns.
const WINDOW: usize = 120;

impl Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl Diagnostic {
    /// The message as lines of text, without a newline at the end; `color` adds ANSI styles.
    pub fn render(&self, color: bool) -> String {
        let paint = Paint { color };
        let (word, hue) = match self.severity {
            Severity::Error => ("error", AnsiColor::BrightRed),
            Severity::Warning => ("warning", AnsiColor::Yellow),
        };
        let hue = hue.on_default().bold();
        let mut out = format!(
            "{}: {}",
            paint.with(hue, &format!("{word}[{}]", self.name)),
            paint.with(Style::new().bold(), &printable(&self.message)),
        );
        let places = [Some(&self.span), self.related.as_ref().map(|r| &r.0)];
        let margin = places
            .iter()
            .flatten()
            .filter_map(|span| Some(span.source.as_ref()?.place(span.range.start).line))
            .max()
            .map_or(1, |line| line.to_string().len());
        if self.span.source.is_some() {
            excerpt(&mut out, &self.span, margin, hue, paint);
        } else if let Some(file) = &self.file {
            let arrow = paint.with(frame(), "-->");
            let _ = write!(out, "\n{:margin$}{arrow} {}", "", file.display());
        }
        if let Some(help) = &self.help {
            let help = printable(help);
            let lead = paint.with(frame(), "=");
            let _ = write!(out, "\n{:margin$} {lead} help: {help}", "");
        }
        if let Some((span, note)) = &self.related {
            let word = paint.with(AnsiColor::BrightGreen.on_default().bold(), "note");
            let _ = write!(out, "\n{word}: {}", printable(note));
            excerpt(
                &mut out,
                span,
                margin,
                AnsiColor::BrightGreen.on_default(),
                paint,
            );
        }
        out
    }
}

/// All messages, one empty line between two.
pub fn render_all<'a>(all: impl IntoIterator<Item = &'a Diagnostic>, color: bool) -> String {
    let texts: Vec<_> = all.into_iter().map(|d| d.render(color) + "\n").collect();
    texts.join("\n")
}

#[derive(Clone, Copy)]
struct Paint {
    color: bool,
}

impl Paint {
    fn with(self, style: Style, text: &str) -> String {
        if self.color {
            format!("{style}{text}{style:#}")
        } else {
            text.to_owned()
        }
    }
}

fn frame() -> Style {
    AnsiColor::BrightBlue.on_default().bold()
}

/// ` --> file:line:column`, the source line, and carets.
fn excerpt(out: &mut String, span: &Span, margin: usize, hue: Style, paint: Paint) {
    let Some(source) = &span.source else { return };
    let place = source.place(span.range.start);
    let (arrow, bar) = (paint.with(frame(), "-->"), paint.with(frame(), "|"));
    let _ = write!(
        out,
        "\n{:margin$}{arrow} {}:{}:{}",
        "",
        source.path.display(),
        place.line,
        place.column
    );
    let text = &source.text;
    let start = text.floor_char_boundary(span.range.start);
    let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
    let end = text
        .floor_char_boundary(span.range.end)
        .clamp(start, line_end);
    let line = text[line_start..line_end].trim_end_matches('\r');
    let (shown, from, to) = window(line, start - line_start, end - line_start);
    let number = paint.with(frame(), &format!("{:>margin$}", place.line));
    let space = if shown.is_empty() { "" } else { " " };
    let carets = paint.with(hue, &"^".repeat((to - from).max(1)));
    let _ = write!(out, "\n{:margin$} {bar}\n{number} {bar}{space}{shown}", "");
    let _ = write!(out, "\n{:margin$} {bar} {:from$}{carets}", "", "");
}

/// The line as it is shown, at most [`WINDOW`] columns of it, and the columns of `start..end` in it.
fn window(line: &str, start: usize, end: usize) -> (String, usize, usize) {
    // Of a line of megabytes only the neighborhood is looked at.
    let skipped = line.floor_char_boundary(start.saturating_sub(4 * WINDOW));
    let (line, start, end) = (&line[skipped..], start - skipped, end - skipped);
    let mut cells: Vec<(char, usize)> = Vec::new(); // character, column where it begins
    let (mut column, mut from, mut to) = (0, None, None);
    for (i, c) in line.char_indices() {
        if i >= start {
            from.get_or_insert(column);
        }
        if i >= end {
            to.get_or_insert(column);
        }
        if to.is_some_and(|to| column > to + WINDOW) {
            break;
        }
        match c {
            '\t' => {
                let next = (column / TAB + 1) * TAB;
                cells.extend((column..next).map(|at| (' ', at)));
                column = next;
            }
            c => {
                let c = printable_char(c);
                cells.push((c, column));
                column += c.width().unwrap_or(0);
            }
        }
    }
    let (from, to) = (from.unwrap_or(column), to.unwrap_or(column));
    if column <= WINDOW && skipped == 0 {
        return (cells.into_iter().map(|(c, _)| c).collect(), from, to);
    }
    let first = from.saturating_sub(WINDOW / 3);
    let last = first + WINDOW;
    let body = cells.iter().filter(|(_, at)| (first..last).contains(at));
    let lead = if first + skipped > 0 { "…" } else { "" };
    let tail = if column > last { "…" } else { "" };
    let shown = body.map(|(c, _)| *c).collect::<String>();
    let shift = lead.chars().count();
    let clip = |column: usize| column.min(last) - first + shift;
    (format!("{lead}{shown}{tail}"), clip(from), clip(to))
}

/// What could move the terminal's cursor or turn the direction of text is shown as a replacement
/// character.
fn printable_char(c: char) -> char {
    let is_direction = matches!(
        c,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    if c.is_control() || is_direction {
        char::REPLACEMENT_CHARACTER
    } else {
        c
    }
}

/// Text from elsewhere as it can be shown; lines stay.
pub fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if c == '\n' { c } else { printable_char(c) })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::diagnostic::Source;

    fn at(text: &str, range: std::ops::Range<usize>) -> Diagnostic {
        let source = Source {
            path: "a.toml".into(),
            text: text.to_owned(),
            returned: None,
        };
        let span = Span {
            source: Some(Arc::new(source)),
            range,
        };
        Diagnostic::at("kind-of", span, "it is wrong")
    }

    #[test]
    fn carets_stand_under_tabs_wide_and_combining_letters() {
        let text = "\t大e\u{301} = x\r\nnext";
        let x = text.find('x').expect("it is there");
        let want = "error[kind-of]: it is wrong\n --> a.toml:1:8\n  |\n\
                    1 |     大e\u{301} = x\n  |           ^";
        assert_eq!(at(text, x..x + 1).render(false), want);
    }

    #[test]
    fn a_span_over_lines_is_marked_to_the_end_of_its_first() {
        let text = "a = [\n1,\n]\n";
        assert!(
            at(text, 4..text.len())
                .render(false)
                .ends_with("1 | a = [\n  |     ^")
        );
        let end = at(text, text.len()..text.len()).render(false);
        assert!(end.ends_with(" --> a.toml:4:1\n  |\n4 |\n  | ^"), "{end}");
    }

    #[test]
    fn color_adds_styles_and_nothing_else() {
        let message = at("a = 1\n", 0..1).help("rename it");
        let colored = message.render(true);
        assert!(colored.contains("\u{1b}["));
        let mut plain = String::new();
        for (i, part) in colored.split('\u{1b}').enumerate() {
            let text = part
                .split_once('m')
                .filter(|_| i > 0)
                .map_or(part, |(_, text)| text);
            plain.push_str(text);
        }
        assert_eq!(plain, message.render(false));
        assert!(!plain.contains('\u{1b}'));
    }

    #[test]
    fn caret_is_aligned_far_along_a_long_line() {
        let text = format!("{}wrong{}", "é, ".repeat(400), " b".repeat(400));
        let start = text.find("wrong").expect("it is there");
        let shown = at(&text, start..start + 5).render(false);
        let lines: Vec<_> = shown.lines().collect();
        let column = |line: &str, word: &str| line.split(word).next().map(|l| l.chars().count());
        assert_eq!(
            column(lines[3], "wrong"),
            column(lines[4], "^^^^^"),
            "{shown}"
        );
        assert!(
            lines[3].starts_with("1 | …") && lines[3].ends_with('…'),
            "{shown}"
        );
    }
}
