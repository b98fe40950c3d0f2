//! Diagnostics for people: the message, the source line with carets under the span, and the help, laid out
//! by the renderer of rustc.

use std::{
    env,
    fmt::{self, Display},
    io::{self, IsTerminal as _},
};

use annotate_snippets::{
    AnnotationKind, Group, Level, Origin, Renderer, Snippet, renderer::DEFAULT_TERM_WIDTH,
};

use reflet_base::standard_error::write_error;

use super::{Diagnostic, Severity, Span, at_most};

/// Length of a line, bytes, above which only the neighborhood of the span goes to the renderer, because it
/// looks at every character.
const LONG_LINE: usize = 64 << 10;

impl Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl Diagnostic {
    /// The message as lines of text, without a newline at the end; `color` adds ANSI styles.
    pub fn render(&self, color: bool) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level.primary_title(printable(&self.message));
        let mut group = Group::with_title(title.id(self.name));
        if self.span.source.is_some() {
            group = excerpt(group, &self.span);
        } else if let Some(file) = &self.file {
            group = group.element(Origin::path(printable(&file.display().to_string())));
        }
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(printable(help)));
        }
        let note = self.related.as_ref().map(|(span, note)| {
            let title = Level::NOTE.secondary_title(printable(note));
            excerpt(Group::with_title(title), span)
        });
        let groups: Vec<_> = std::iter::once(group).chain(note).collect();
        let renderer = if color {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        renderer.render(&groups)
    }
}

/// All messages, with an empty line between two.
pub fn render_all<'a>(all: impl IntoIterator<Item = &'a Diagnostic>, color: bool) -> String {
    let texts: Vec<_> = all.into_iter().map(|d| d.render(color) + "\n").collect();
    texts.join("\n")
}

/// The group with `--> file:line:column`, the first line of the span, and carets under the part of the span in
/// that line.
fn excerpt<'a>(group: Group<'a>, span: &Span) -> Group<'a> {
    let Some(source) = &span.source else {
        return group;
    };
    let path = printable(&source.path.display().to_string());
    if source.generated {
        return group.element(Origin::path(path));
    }
    let text = &source.text;
    let place = source.place(span.range.start);
    let first = source.start_of_text();
    let start = text.floor_char_boundary(span.range.start).max(first);
    let line_start = text[..start].rfind('\n').map_or(first, |i| i + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
    let end = text.floor_char_boundary(span.range.end);
    let end = end.clamp(start, line_end);
    let near = 4 * DEFAULT_TERM_WIDTH;
    let is_long = line_end - line_start > LONG_LINE;
    let (from, to) = match is_long {
        true => (
            text.floor_char_boundary(start.saturating_sub(near))
                .max(line_start),
            text.floor_char_boundary(end.min(start + near) + near)
                .min(line_end),
        ),
        false => (line_start, line_end),
    };
    // A replacement may have another length in bytes, so each part is made printable on its own.
    let mut line = printable_line(&text[from..start]);
    let first = line.len();
    line += &printable_line(&text[start..end.min(to)]);
    let carets = first..line.len();
    line += &printable_line(text[end.min(to)..to].trim_end_matches('\r'));
    let carets = AnnotationKind::Primary.span(carets);
    let snippet = Snippet::source(line)
        .line_start(place.line)
        .annotation(carets);
    if is_long {
        let origin = Origin::path(path)
            .line(place.line)
            .char_column(place.column);
        group.element(origin).element(snippet)
    } else {
        group.element(snippet.path(path))
    }
}

/// Replaces characters that could move the cursor of the terminal or change the direction of text by the
/// replacement character. The renderer replaces most of them, but neither the control characters beyond ASCII
/// nor all direction marks.
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

/// Text from outside with unprintable characters replaced; newlines stay.
pub fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if c == '\n' { c } else { printable_char(c) })
        .collect()
}

/// Text of several lines for a terminal with unprintable characters replaced; newlines and tabs stay.
pub fn printable_lines(text: &str) -> String {
    let lines: Vec<_> = text.split('\n').map(printable_line).collect();
    lines.join("\n")
}

/// Part of a line with unprintable characters replaced; tabs stay.
fn printable_line(text: &str) -> String {
    text.chars()
        .map(|c| if c == '\t' { c } else { printable_char(c) })
        .collect()
}

/// Writes diagnostics to standard error, in color on a terminal.
pub fn print_diagnostics(diagnostics: &[Diagnostic]) {
    let wants_color = env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let color = wants_color && io::stderr().is_terminal();
    if !diagnostics.is_empty() {
        let text = render_all(&at_most(diagnostics.to_vec()), color);
        write_error(format_args!("{text}"));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        diagnostic::{MOST_SHOWN, Source, at_most},
        syntax::Entries,
    };

    fn diagnostic(text: &str, range: std::ops::Range<usize>) -> Diagnostic {
        let source = Source::new("a.toml", text);
        let span = Span {
            source: Some(Arc::new(source)),
            range,
        };
        Diagnostic::new("kind-of", span, "it is wrong")
    }

    #[test]
    fn a_byte_order_mark_is_neither_counted_nor_shown() {
        let text = "\u{feff}verion = 1\nb = 2\n";
        let want = "error[kind-of]: it is wrong\n --> a.toml:1:1\n  |\n1 | verion = 1\n  | ^^^^^^";
        assert_eq!(diagnostic(text, 3..9).render(false), want);
        assert!(
            diagnostic(text, 0..0)
                .render(false)
                .contains(" --> a.toml:1:1\n")
        );
        assert!(
            diagnostic(text, 14..15)
                .render(false)
                .contains(" --> a.toml:2:1\n")
        );
    }

    #[test]
    fn errors_are_shown_rather_than_warnings() {
        let warning = || diagnostic("a = 1\n", 0..1).warning();
        let mut all: Vec<_> = (0..MOST_SHOWN + 1).map(|_| warning()).collect();
        assert_eq!(at_most(all.clone()).len(), MOST_SHOWN + 1);
        all.push(diagnostic("a = 1\n", 0..1));
        let shown = at_most(all);
        assert_eq!(shown.len(), MOST_SHOWN + 1);
        let errors = shown.iter().filter(|d| d.severity == Severity::Error);
        assert_eq!(errors.count(), 2, "the mistake and the count");
        assert_eq!(shown[MOST_SHOWN].message, "2 more messages are not shown");
    }

    #[test]
    fn carets_stand_under_tabs_wide_and_combining_letters() {
        let text = "\t大e\u{301} = x\r\nnext";
        let x = text.find('x').expect("it is there");
        let want = "error[kind-of]: it is wrong\n --> a.toml:1:8\n  |\n\
                    1 |     大e\u{301} = x\n  |           ^";
        assert_eq!(diagnostic(text, x..x + 1).render(false), want);
    }

    /// Scene that the program generates for a model file: the user never saw a text of it.
    #[test]
    fn a_generated_scene_is_not_shown() {
        let source = Source::generated("a.glb", Entries::new());
        let span = Span {
            source: Some(Arc::new(source)),
            range: 0..0,
        };
        let message = Diagnostic::new("kind-of", span.clone(), "it is wrong");
        let want = "error[kind-of]: it is wrong\n--> a.glb";
        assert_eq!(message.render(false), want);
        assert_eq!(message.span.in_words().as_deref(), Some("a.glb"));
        let broken = Diagnostic::in_file("kind-of", "a.glb".as_ref(), "it is wrong");
        assert_eq!(broken.related(span, "named here").render(false), want);
    }

    #[test]
    fn a_span_over_lines_is_marked_to_the_end_of_its_first() {
        let text = "a = [\n1,\n]\n";
        assert!(
            diagnostic(text, 4..text.len())
                .render(false)
                .ends_with("1 | a = [\n  |     ^")
        );
        let end = diagnostic(text, text.len()..text.len()).render(false);
        assert!(end.ends_with(" --> a.toml:4:1\n  |\n4 |\n  | ^"), "{end}");
    }

    #[test]
    fn color_adds_styles_and_nothing_else() {
        let message = diagnostic("a = 1\n", 0..1).help("rename it");
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
        for times in [400, 100_000] {
            let text = format!("{}wrong{}", "é, ".repeat(times), " b".repeat(times));
            let start = text.find("wrong").expect("it is there");
            let shown = diagnostic(&text, start..start + 5).render(false);
            let place = format!(" a.toml:1:{}\n", 3 * times + 1);
            assert!(shown.contains(&place), "{shown}");
            let mut lines = shown.lines().rev();
            let (carets, line) = (lines.next(), lines.next());
            let column = |line: &str, word| line.split(word).next().map(|l| l.chars().count());
            let want = line.and_then(|line| column(line, "wrong"));
            assert_eq!(want, carets.and_then(|c| column(c, "^^^^^")), "{shown}");
            assert!(shown.chars().count() < 500, "{}", shown.len());
        }
    }

    #[test]
    fn what_moves_cursor_or_direction_is_not_passed_on() {
        let text = "a = \"\u{1b}[31m\u{9b}1m\u{200f}\u{202e}\" wrong";
        let mut message = diagnostic(text, text.len() - 5..text.len()).help("\u{1b}[2J");
        message.message = "a\u{9b}\rb".into();
        let shown = message.render(false);
        assert!(
            shown.chars().all(|c| c == '\n' || printable_char(c) == c),
            "{shown:?}"
        );
        assert!(shown.ends_with("= help: \u{fffd}[2J"), "{shown}");
    }
}
