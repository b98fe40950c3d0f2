//! Messages to the user: the place in a file, the mistake, the expectation, and the cure.

mod render;
mod setup_locations;

pub use render::{print_diagnostics, printable, printable_lines, render_all};
pub use setup_locations::{Returned, TABLES};

use std::{
    ops::Range,
    path::{Path, PathBuf},
    string::FromUtf8Error,
    sync::{Arc, OnceLock},
};

use super::syntax::{Entries, SyntaxTree, Token, to_text, tokens};

/// A text that messages point into, with its syntax tree if it is scene text.
#[derive(Debug)]
pub struct Source {
    /// The file as the user named it.
    pub path: PathBuf,
    /// Its whole text.
    pub text: String,
    /// For text that a script returned, which has no file: the places in the script to point to instead.
    pub returned: Option<Returned>,
    /// Whether the program generated the text for a model file; messages then name the path alone.
    pub generated: bool,
    /// Tree of the text, made when it is first asked for; so are the tokens.
    syntax: OnceLock<SyntaxTree>,
    tokens: OnceLock<Vec<Token>>,
}

/// Largest number of messages about one scene that are shown; a text with more mistakes is most likely not a scene.
pub const MOST_SHOWN: usize = 100;

/// The last message of a list from which `count` messages are left out.
pub fn left_out(count: usize, has_errors: bool) -> Diagnostic {
    let message = match count {
        1 => "1 more message is not shown".to_owned(),
        _ => format!("{count} more messages are not shown"),
    };
    let message = Diagnostic::new("too-many-errors", Span::default(), message);
    match has_errors {
        true => message,
        false => message.warning(),
    }
}

/// At most [`MOST_SHOWN`] of the messages, in their order and errors rather than warnings, and the number of
/// those left out.
pub fn at_most(messages: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let surplus = messages.len().saturating_sub(MOST_SHOWN + 1);
    if surplus == 0 {
        return messages;
    }
    let is_error = |d: &Diagnostic| d.severity == Severity::Error;
    let errors = messages.iter().filter(|d| is_error(d)).count();
    let mut left = [MOST_SHOWN.saturating_sub(errors), MOST_SHOWN];
    let mut kept = messages;
    let before = kept.len();
    kept.retain(|d| {
        let left = &mut left[usize::from(is_error(d))];
        let keeps = *left > 0;
        *left -= usize::from(keeps);
        keeps
    });
    kept.push(left_out(before - kept.len(), errors > 0));
    kept
}

/// A range of bytes in a [`Source`]; the default span points nowhere.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// The file, if the value was written in one.
    pub source: Option<Arc<Source>>,
    /// Byte range in the file's text.
    pub range: Range<usize>,
}

words! {
    /// Severity of a message.
    pub enum Severity {
        /// A mistake because of which nothing is rendered.
        Error = "error",
        /// The scene is rendered, but not all of it as written.
        Warning = "warning",
    }
}

/// One message to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Severity: error or warning.
    pub severity: Severity,
    /// Stable kebab-case name of the kind of message, such as `unknown-key` or `alpha-blend-opaque`.
    pub name: &'static str,
    /// The mistake and the expectation, in one sentence.
    pub message: String,
    /// Place of the mistake in a text.
    pub span: Span,
    /// A file (and place inside it, such as `mesh 3 "wall"`) when no text span exists.
    pub file: Option<PathBuf>,
    /// Advice on what to do, such as `did you mean "eye"?`.
    pub help: Option<String>,
    /// A second place with a note (the other end of a dangling or doubled name).
    pub related: Option<(Span, String)>,
}

/// A place in a text for people: lines and columns count from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line number, from 1.
    pub line: usize,
    /// Number of the character in the line, from 1.
    pub column: usize,
}

impl Source {
    /// Text of a file; `path` is its name in messages.
    pub fn new(path: impl AsRef<Path>, text: impl Into<String>) -> Self {
        Self {
            path: path.as_ref().to_owned(),
            text: text.into(),
            returned: None,
            generated: false,
            syntax: OnceLock::new(),
            tokens: OnceLock::new(),
        }
    }

    /// Scene that the program generates for a model file at `path`: a tree whose ranges are all empty. Its text is for
    /// copying and comparing scenes.
    pub fn generated(path: impl AsRef<Path>, root: Entries) -> Self {
        let text = to_text(&root);
        Self {
            generated: true,
            syntax: OnceLock::from(SyntaxTree::new(root)),
            ..Self::new(path, text)
        }
    }

    /// Text that a script returned; `script` is the name of the script in messages.
    pub fn returned(script: &str, returned: Returned, text: String) -> Self {
        Self {
            returned: Some(returned),
            ..Self::new(script, text)
        }
    }

    /// Syntax tree of the text as scene text, which is parsed by the first call.
    pub fn syntax(&self) -> &SyntaxTree {
        self.syntax.get_or_init(|| SyntaxTree::parse(&self.text))
    }

    /// Tokens of the text as scene text, in its order and without gaps.
    pub fn tokens(&self) -> &[Token] {
        self.tokens.get_or_init(|| tokens(&self.text))
    }

    /// Offset of the first character, after a byte order mark.
    pub fn start_of_text(&self) -> usize {
        match self.text.starts_with('\u{feff}') {
            true => '\u{feff}'.len_utf8(),
            false => 0,
        }
    }

    /// Line and column of a byte offset; an offset past the end means the end.
    pub fn place(&self, offset: usize) -> Place {
        let offset = self.text.floor_char_boundary(offset);
        // A byte order mark is no character of the first line.
        let start = self.start_of_text();
        let before = &self.text[start..offset.max(start)];
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        Place {
            line: 1 + before.bytes().filter(|&b| b == b'\n').count(),
            column: 1 + before[line_start..].chars().count(),
        }
    }
}

/// Tree and tokens follow from the text.
impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        (&self.path, &self.text, &self.returned, self.generated)
            == (&other.path, &other.text, &other.returned, other.generated)
    }
}

impl Eq for Source {}

impl Span {
    /// Span of the first byte of a file that is not UTF-8.
    pub fn not_utf8(path: &Path, wrong: &FromUtf8Error) -> Self {
        let start = wrong.utf8_error().valid_up_to();
        // The valid part keeps its length; the first wrong bytes show as one replacement
        // character.
        let source = Source::new(path, String::from_utf8_lossy(wrong.as_bytes()).into_owned());
        Self {
            source: Some(source.into()),
            range: start..start + '\u{FFFD}'.len_utf8(),
        }
    }

    /// The span that messages point to: for text that a script returned, the place in the script.
    pub fn shown(self) -> Self {
        self.in_script().map_or(self, |(span, _)| span)
    }

    /// The place as `file:line:column`, or the model file for which the program generated the text; `None` for the
    /// default span.
    pub fn in_words(&self) -> Option<String> {
        let source = self.source.as_ref()?;
        let path = source.path.display();
        if source.generated {
            return Some(path.to_string());
        }
        let place = source.place(self.range.start);
        Some(format!("{path}:{}:{}", place.line, place.column))
    }

    /// For a span of text that a script returned: the place in the script, and the entry's name.
    fn in_script(&self) -> Option<(Self, String)> {
        let source = self.source.as_ref()?;
        let returned = source.returned.as_ref()?;
        Some(returned.explain(source, &self.range))
    }
}

impl Diagnostic {
    /// An error at a place in a text; for text that a script returned, the message names the entry and
    /// points into the script.
    pub fn new(name: &'static str, span: Span, message: impl Into<String>) -> Self {
        let (span, message) = match span.in_script() {
            Some((span, entry)) => (span, format!("{entry}: {}", message.into())),
            None => (span, message.into()),
        };
        Self {
            severity: Severity::Error,
            name,
            message,
            span,
            file: None,
            help: None,
            related: None,
        }
    }

    /// The same message with advice on what to do; empty for none.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        let help = help.into();
        self.help = (!help.is_empty()).then_some(help);
        self
    }

    /// The same message with a second place and a note on it; left out where the program generated the
    /// text there.
    pub fn related(mut self, span: Span, note: impl Into<String>) -> Self {
        if span.source.as_ref().is_some_and(|source| source.generated) {
            return self;
        }
        self.related = Some((span.shown(), note.into()));
        self
    }

    /// The same message as a warning.
    pub fn warning(mut self) -> Self {
        self.severity = Severity::Warning;
        self
    }

    /// Path of the file that the message is about; `None` for none.
    pub fn path(&self) -> Option<&Path> {
        let source = self
            .span
            .source
            .as_ref()
            .map(|source| source.path.as_path());
        source.or(self.file.as_deref())
    }

    /// An error in a file that has no text positions (glTF, images).
    pub fn in_file(name: &'static str, file: &Path, message: impl Into<String>) -> Self {
        Self {
            file: Some(file.to_owned()),
            ..Self::new(name, Span::default(), message)
        }
    }
}
