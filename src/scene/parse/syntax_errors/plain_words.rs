//! Syntax errors of TOML in plain words: the mistake, and the text to write instead.

use std::{borrow::Cow, ops::Range, sync::LazyLock};

use super::{
    MOST_READ, Mistake, Words, begin_of,
    numbers::{constant, number},
    several::several,
    value_types::types_of,
    words,
};
use crate::{
    forms::{self, Form},
    suggest,
    syntax::key_text,
    table::color::in_css,
};

/// Message and advice for a syntax error at `at` of a scene or a project; the parser's own `message` where no explanation
/// fits. The place is one of the text.
pub fn in_plain_words(text: &str, at: &Range<usize>, message: &str, is_project: bool) -> Words {
    let start = text.floor_char_boundary(at.start);
    let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
    let (key, _) = (text[line_start..line_end].split_once('=')).unwrap_or_default();
    let key = begin_of(key);
    // A mistake is near its place, and expressions would look through megabytes of a line for seconds.
    let first = line_start.max(text.ceil_char_boundary(start.saturating_sub(MOST_READ)));
    let rest = begin_of(&text[start..line_end]);
    let line = &text[first..start + rest.len()];
    let value = line.split_once('=').map_or(line, |(_, value)| value);
    let mistake = Mistake {
        found: begin_of(text.get(at.clone()).unwrap_or("")),
        rest: rest.trim_end(),
        line: line.trim(),
        is_from_start: first == line_start,
        key: key.trim(),
        table: table_of(&text[..line_start], key),
        value: without_comment(value).trim(),
        message,
        is_project,
    };
    let plain = |message: String, help| Words {
        message,
        help,
        at: None,
    };
    if has_lone_return(&text[..line_end], start) {
        let message = "a line ends with a carriage return alone";
        let help = "save the file with line ends that your editor calls LF or CRLF";
        return plain(message.to_owned(), Some(help.to_owned()));
    }
    let explained = FORMS.iter().find_map(|(explain, form)| match explain {
        Some(explain) => explain(&mistake),
        None => {
            let (_, message, help) = form.found(|name| mistake.part(name))?;
            words(message, help)
        }
    });
    let Some(words) = explained else {
        return plain(format!("not TOML: {message}"), None);
    };
    let indent = first + line.len() - line.trim_start().len();
    let moved = |own: Range<usize>| indent + own.start..indent + own.end;
    Words {
        at: words.at.map(moved),
        ..words
    }
}

/// Whether a carriage return without a newline is at a place or just before it.
fn has_lone_return(text: &str, at: usize) -> bool {
    let bytes = text.as_bytes();
    let is_lone = |at: usize| bytes.get(at) == Some(&b'\r') && at + 1 < bytes.len();
    is_lone(at) || at.checked_sub(1).is_some_and(is_lone)
}

/// Forms in order, some with a function that explains them; the first one that fits the mistake is used.
static FORMS: LazyLock<Vec<(Option<Explain>, Form)>> = LazyLock::new(|| {
    let explain = |form: &Form| -> Option<Explain> {
        Some(match form.written.as_str() {
            "header" => header,
            "backslash" => backslash,
            "css_color" => css_color,
            "constant" => constant,
            "number" => number,
            "several" => several,
            _ => return None,
        })
    };
    let forms = forms::of_file(include_str!("forms.toml")).into_iter();
    forms.map(|form| (explain(&form), form)).collect()
});

/// A function that explains a mistake.
type Explain = fn(&Mistake) -> Option<Words>;

impl<'t> Mistake<'t> {
    /// Whether the key takes lists and no number.
    fn takes_a_list(&self) -> bool {
        let name = self.key.rsplit('.').next().unwrap_or(self.key);
        let types = types_of(self.is_project, self.table, name);
        types.is_some_and(|types| !types.number && !types.lists.is_empty())
    }

    /// A part of the text by its name in `forms.toml`; `None` where the mistake has none.
    fn part(&self, name: &str) -> Option<Cow<'t, str>> {
        let unquoted = self.message.starts_with("string values must be quoted");
        // For a word that begins like `true` or `nan`, the parser says that it expects that one.
        let is_bare = self.value.starts_with(char::is_alphabetic)
            && self.value.chars().all(char::is_alphanumeric)
            && self.message.starts_with("invalid ");
        match name {
            "line" | "place" | "value" | "list" | "entry" if !self.is_from_start => None,
            "line" => Some(self.line.into()),
            "rest" => Some(self.rest.into()),
            "place" => {
                let before = self.line.len().checked_sub(self.rest.len())?;
                Some(format!("{}¦{}", self.line.get(..before)?, self.rest).into())
            }
            "value" => Some(self.value.into()),
            "list" if self.takes_a_list() => Some(self.value.into()),
            "message" => Some(self.message.into()),
            "key" => Some(self.key.into()),
            "entry" if !self.key.is_empty() => {
                Some(format!("{} = {}", self.key, self.value).into())
            }
            "word" if unquoted => Some(self.found.into()),
            "word" if is_bare => Some(self.value.into()),
            _ => None,
        }
    }
}

/// Kind of the table that a key below a text is in, such as `material`; variants have tables of the scene. Empty for none.
fn table_of<'t>(before: &'t str, key: &'t str) -> &'t str {
    let headers = before
        .lines()
        .rev()
        .map(|line| without_comment(line).trim());
    let mut headers =
        headers.filter_map(|line| Some(line.strip_prefix('[')?.trim_matches(['[', ']', ' '])));
    let header = headers.find(|inner| inner.starts_with(char::is_alphabetic));
    let mut words = header.into_iter().flat_map(|it| it.split('.'));
    let mut words = words
        .by_ref()
        .chain(key.split('.'))
        .map(str::trim)
        .peekable();
    if words.next_if_eq(&"variant").is_some() {
        words.next();
    }
    let kind = words.next();
    kind.filter(|_| words.peek().is_some()).unwrap_or_default()
}

fn without_comment(value: &str) -> &str {
    let mut quote = None;
    for (i, c) in value.char_indices() {
        match (quote, c) {
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if open == c => quote = None,
            (None, '#') => return &value[..i],
            _ => {}
        }
    }
    value
}

/// Explains a malformed table header: `[material red]`, `[[instance]`.
fn header(m: &Mistake) -> Option<Words> {
    let in_braces = m
        .line
        .strip_prefix('{')
        .filter(|inner| inner.ends_with('}'));
    let inner = m.line.strip_prefix('[').or(in_braces)?;
    let has_name =
        inner.starts_with(['[', ' ', '"', '\'']) || inner.starts_with(char::is_alphabetic);
    (has_name && m.key.is_empty() && m.is_from_start).then_some(())?;
    let inner = without_comment(inner).trim_matches(['[', ']', '{', '}', ':', ';', ',', ' ']);
    // Words of a name may stand apart where points divide the names.
    let between: &[char] = if inner.contains('.') {
        &['.']
    } else {
        &[' ', ':', '/']
    };
    let names = inner.split(between).map(str::trim);
    let names: Vec<_> = names.filter(|name| !name.is_empty()).collect();
    let is_name = |n: &&str| n.chars().all(|c| c.is_alphanumeric() || " _-".contains(c));
    let help = match names.as_slice() {
        ["instance" | "instances"] => "write `[[instance]]`".to_owned(),
        all if !all.is_empty() && all.iter().all(is_name) => {
            let all: Vec<_> = all.iter().map(|name| key_text(name)).collect();
            format!("write `[{}]`", suggest::clip(&all.join(".")))
        }
        _ => {
            "write `[camera.main]`, or `[[instance]]`; a name with other characters than letters, \
              digits, `_` and `-` stands in quotes"
                .to_owned()
        }
    };
    let message = format!(
        "`{}` is not a valid table header",
        suggest::clip(m.line.trim())
    );
    words(message, help)
}

/// Explains a backslash in double quotes: `file = "C:\assets"`.
fn backslash(m: &Mistake) -> Option<Words> {
    (m.message.contains("escape") || m.message.contains("unicode")).then_some(())?;
    // In a table in braces, the text with the backslash.
    let mut texts = m.value.split('"');
    let text = texts.find(|text| text.contains('\\')).unwrap_or(m.value);
    let slashes = text.replace('\\', "/");
    let message = "`\\` has a special meaning in double quotes";
    let is_absolute = slashes.contains(':') || slashes.starts_with('/');
    let name = slashes.rsplit('/').next().filter(|_| is_absolute);
    let why = match name {
        Some(_) => "its name in the scene's folder, or its folder is given by `--assets DIR`",
        None => "with `/`, as on all systems",
    };
    let path = suggest::clip(name.unwrap_or(&slashes));
    words(message, format!("write \"{path}\", {why}"))
}

/// Explains a color of a stylesheet: `base_color = rgb(255, 0, 0)`.
fn css_color(m: &Mistake) -> Option<Words> {
    let (function, _) = m.value.split_once('(')?;
    let color = in_css(m.value)?;
    let (r, g, b) = (color.red, color.green, color.blue);
    let message = format!("TOML has no function {}", suggest::key(function.trim()));
    words(message, format!("write \"#{r:02x}{g:02x}{b:02x}\""))
}
