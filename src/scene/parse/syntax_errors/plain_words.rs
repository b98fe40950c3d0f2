//! Syntax errors of TOML in plain words: the mistake, and the text to write instead.

use std::ops::Range;

use super::{
    Mistake, Words, is_number,
    numbers::{constant, number},
    words,
};
use crate::{suggest, table::color::in_css};

/// Message and advice for a syntax error at `at`; the parser's own `message` where no explanation fits.
pub fn in_plain_words(text: &str, at: &Range<usize>, message: &str) -> Words {
    let start = text.floor_char_boundary(at.start);
    let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
    let line = &text[line_start..line_end];
    let (key, value) = line.split_once('=').unwrap_or(("", line));
    let mistake = Mistake {
        found: text.get(at.clone()).unwrap_or(""),
        rest: text[start..line_end].trim_end(),
        line: line.trim(),
        key: key.trim(),
        value: without_comment(value).trim(),
        message,
    };
    if has_lone_return(&text[..line_end], start) {
        let message = "a line ends with a carriage return alone";
        let help = "save the file with line ends that your editor calls LF or CRLF";
        return (message.to_owned(), Some(help.to_owned()));
    }
    let explained = EXPLANATIONS.iter().find_map(|explain| explain(&mistake));
    explained.unwrap_or_else(|| (format!("not TOML: {message}"), None))
}

/// Whether a carriage return without a newline is at a place or just before it.
fn has_lone_return(text: &str, at: usize) -> bool {
    let bytes = text.as_bytes();
    let is_lone = |at: usize| bytes.get(at) == Some(&b'\r') && at + 1 < bytes.len();
    is_lone(at) || at.checked_sub(1).is_some_and(is_lone)
}

/// Explanations in order; the first one that fits the mistake is used.
const EXPLANATIONS: [fn(&Mistake) -> Option<Words>; 16] = [
    hash_color,
    typographic_quotes,
    comment,
    header,
    backslash,
    assignment,
    two_keys,
    colon,
    joined,
    line_end,
    parentheses,
    constant,
    word,
    number,
    quotes,
    equals,
];

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

/// Whether a text is a key, perhaps with dots.
fn is_key(text: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || "_-.".contains(c);
    !text.is_empty() && text.chars().all(is_part)
}

/// Advice to write a key with a value.
fn written(key: &str, value: &str) -> String {
    format!("write `{} = {}`", suggest::clip(key), suggest::clip(value))
}

/// Explains a color without quotes: `base_color = #ff8800`.
fn hash_color(m: &Mistake) -> Option<Words> {
    let (_, raw) = m.line.split_once('=')?;
    let color = raw.trim().strip_prefix('#')?;
    let digits = color.chars().take_while(char::is_ascii_hexdigit).count();
    (m.value.is_empty() && digits >= 3).then_some(())?;
    let message = "`#` begins a comment, so there is no value";
    words(
        message,
        format!("write \"#{}\", in quotes", &color[..digits]),
    )
}

/// Explains typographic quotes: `model = “box”`.
fn typographic_quotes(m: &Mistake) -> Option<Words> {
    let is_quote = |c: char| "“”„‘’«»".contains(c);
    let inner = m.value.strip_prefix(is_quote)?.trim_end_matches(is_quote);
    let help = format!("write {}, with straight quotes", suggest::text(inner));
    let quote: String = m.value.chars().take(1).collect();
    let message = format!("`{quote}` is a typographic quote, which TOML does not know");
    words(message, help)
}

/// Explains a comment in the form of another language: `roughness = 0.5 // glossy`.
fn comment(m: &Mistake) -> Option<Words> {
    let here = if m.rest.starts_with('/') {
        m.rest
    } else {
        m.line
    };
    let sign = ["//", "/*", "--", "<!--"]
        .into_iter()
        .find(|s| here.starts_with(s))?;
    let text = here[sign.len()..]
        .trim()
        .trim_end_matches("*/")
        .trim_end_matches("-->");
    words(
        "comments begin with `#`",
        format!("write `# {}`", suggest::clip(text.trim())),
    )
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
    (has_name && m.key.is_empty()).then_some(())?;
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
    let is_bare = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
    let written = |n: &&str| match n.chars().all(is_bare) {
        true => (*n).to_owned(),
        false => format!("\"{n}\""),
    };
    let help = match names.as_slice() {
        ["instance" | "instances"] => "write `[[instance]]`".to_owned(),
        all if !all.is_empty() && all.iter().all(is_name) => {
            let all: Vec<_> = all.iter().map(written).collect();
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

/// Explains another sign of assignment: `roughness := 0.5`, `roughness => 0.5`.
fn assignment(m: &Mistake) -> Option<Words> {
    const SIGNS: [&str; 7] = [":=", "=>", "+=", "==", "<-", "->", "~="];
    let end = m
        .line
        .find(|c: char| !(c.is_alphanumeric() || " _-.\"".contains(c)))?;
    let sign = |sign: &&&str| {
        m.line[end..].starts_with(**sign)
            || m.line[..end].ends_with(&sign[..1]) && m.line[end..].starts_with(&sign[1..])
    };
    let sign = SIGNS.iter().find(sign)?;
    let (key, value) = m.line.split_once(sign)?;
    words(
        format!("between a key and its value stands `=`, not `{sign}`"),
        written(key.trim(), value.trim()),
    )
}

/// Explains two keys on a line: `roughness = 0.5, metallic = 1`.
fn two_keys(m: &Mistake) -> Option<Words> {
    (!m.value.starts_with(['{', '[', '"', '\'']) && !m.key.is_empty()).then_some(())?;
    let (before, value) = m.value.split_once('=')?;
    let (first, key) = before.trim_end().rsplit_once([' ', ',', ';'])?;
    (is_key(key) && !first.contains('(')).then_some(())?;
    let message = format!("`{}` and `{key}` stand on one line", suggest::clip(m.key));
    words(
        message,
        written(key, value.trim()) + " on a line of its own",
    )
}

/// Explains texts that are added up: `file = "a" + ".glb"`.
fn joined(m: &Mistake) -> Option<Words> {
    let parts: Option<Vec<_>> = m
        .value
        .split('+')
        .map(|part| part.trim().strip_prefix('"')?.strip_suffix('"'))
        .collect();
    let parts = parts.filter(|parts| parts.len() > 1)?;
    let help = format!("write {}", suggest::text(&parts.concat()));
    words("TOML does not join texts by `+`", help)
}

/// Explains a backslash in double quotes: `file = "C:\assets"`.
fn backslash(m: &Mistake) -> Option<Words> {
    (m.message.contains("escape") || m.message.contains("unicode")).then_some(())?;
    let text = m.value.trim_matches('"');
    let slashes = text.replace('\\', "/");
    let message = "`\\` has a special meaning in double quotes";
    let help = format!(
        "write \"{}\", with `/`, as on all systems",
        suggest::clip(&slashes)
    );
    words(message, help)
}

/// Explains a colon in place of `=`: `metallic: 1`, `{ kind: "box" }`.
fn colon(m: &Mistake) -> Option<Words> {
    let at = match m.rest.starts_with(':') {
        true => m.line.len().checked_sub(m.rest.len())?,
        false => m.line.find(':')?,
    };
    let (key, value) = (m.line.get(..at)?, m.line.get(at + 1..)?);
    let value = value
        .split(['}', ','])
        .next()
        .filter(|_| key.contains('{'))
        .unwrap_or(value);
    let key = key.rsplit(['{', ',']).next().unwrap_or(key);
    let key = key.trim().trim_matches('"');
    let at_colon = m.found.starts_with(':') || m.rest.starts_with(':');
    (is_key(key) && at_colon).then_some(())?;
    let help = written(key, value.trim().trim_end_matches(','));
    words("between a key and its value stands `=`, not `:`", help)
}

/// Explains a `;` or `,` after a value, or a list without brackets: `roughness = 0.5;`, `base_color = 1, 0, 0`.
fn line_end(m: &Mistake) -> Option<Words> {
    let value = m.value;
    if let Some(own) = value.strip_suffix([';', ',']).filter(|_| !m.key.is_empty()) {
        let sign = &value[own.len()..];
        let message = format!("`{sign}` does not belong at the end of the line");
        return words(message, written(m.key, own.trim()));
    }
    let parts: Vec<_> = value.split(',').map(str::trim).collect();
    (parts.len() > 1 && parts.iter().all(|part| is_number(part))).then_some(())?;
    let list = format!("[{}]", parts.join(", "));
    match parts.as_slice() {
        [whole, rest]
            if rest.len() == 3 && !whole.contains('.') && is_number(whole) && *whole != "0" =>
        {
            let help = format!("write {whole}{rest}, or {whole}.{rest} with a decimal point");
            words(
                format!("`{whole},{rest}` is no number: commas stand between numbers"),
                help,
            )
        }
        [whole, rest] if !whole.contains('.') && !rest.contains('.') => {
            let help = format!("write {whole}.{rest}, or as a list {list}");
            words("numbers have a decimal point `.`, not a comma `,`", help)
        }
        _ => words(
            "a list stands in square brackets `[ ]`",
            format!("write {list}"),
        ),
    }
}

/// Explains a list in parentheses: `eye = (0, 1.6, 5)`, `eye = vec3(0, 1.6, 5)`.
fn parentheses(m: &Mistake) -> Option<Words> {
    let (before, inner) = m.value.split_once('(')?;
    let is_call = before
        .trim()
        .chars()
        .all(|c| c.is_alphanumeric() || "_.".contains(c));
    let inner = inner.strip_suffix(')').filter(|_| is_call)?;
    if let Some(color) = in_css(m.value) {
        let (r, g, b) = (color.red, color.green, color.blue);
        let message = format!("TOML has no function {}", suggest::key(before.trim()));
        return words(message, format!("write \"#{r:02x}{g:02x}{b:02x}\""));
    }
    let parts: Vec<_> = inner.split(',').map(str::trim).collect();
    if parts.iter().all(|part| part.contains('=')) {
        let help = format!("write {{ {} }}", suggest::clip(&parts.join(", ")));
        return words(
            "a table stands in braces `{ }`, not in parentheses `( )`",
            help,
        );
    }
    parts.iter().all(|part| is_number(part)).then_some(())?;
    let help = format!("write [{}]", parts.join(", "));
    words(
        "a list stands in square brackets `[ ]`, not in parentheses `( )`",
        help,
    )
}

/// Explains a word that is no TOML value: `dynamic = True`, `material = red`.
fn word(m: &Mistake) -> Option<Words> {
    let unquoted = m.message.starts_with("string values must be quoted");
    if unquoted && m.found.is_empty() {
        let help = "write a value, or remove the key for its default";
        return words("a value is missing after `=`", help);
    }
    // For a word that begins like `true` or `nan`, the parser says that it expects that one.
    let is_bare = !m.value.is_empty() && m.value.chars().all(char::is_alphanumeric);
    let like_word = is_bare && m.value.starts_with(char::is_alphabetic);
    let found = match () {
        () if unquoted => m.found,
        () if like_word && m.message.starts_with("invalid ") => m.value,
        () => return None,
    };
    let instead = match found.to_ascii_lowercase().as_str() {
        "true" | "yes" | "on" => "true",
        "false" | "no" | "off" => "false",
        "none" | "null" | "nil" => {
            let message = format!("there is no {} in TOML", suggest::key(found));
            return words(message, "leave the key out for its default");
        }
        _ => "",
    };
    if !instead.is_empty() {
        let message = format!("{} is not a value", suggest::key(found));
        return words(message, format!("write {instead}"));
    }
    if found.starts_with(['$', '~', '%']) {
        let message = format!(
            "{} is no path: scenes know no variables of the environment and no home folder",
            suggest::key(found)
        );
        return words(
            message,
            "write the path from the scene's folder, or add its folder by `--assets DIR`",
        );
    }
    let parts: Vec<&str> = found.split_whitespace().collect();
    if parts.len() > 1 && parts.iter().all(|word| is_number(word)) {
        let help = format!("write {}", parts.join(", "));
        let message = format!(
            "a comma is missing between `{}` and `{}`",
            parts[0], parts[1]
        );
        return words(message, help);
    }
    number(m).or_else(|| {
        let message = format!("{} must be in quotes", suggest::key(found));
        words(
            message,
            format!("write {}", suggest::text(found.trim_matches('`'))),
        )
    })
}

/// Explains a missing closing quote: `model = "box`.
fn quotes(m: &Mistake) -> Option<Words> {
    let is_open = |(kind, quote)| {
        m.message
            .starts_with(&format!("invalid {kind} string, expected `{quote}`"))
    };
    let (_, quote) = [("basic", '"'), ("literal", '\'')]
        .into_iter()
        .find(|kind| is_open(*kind))?;
    if quote == '\'' {
        return words(
            "the text in quotes `'` does not end on its line",
            "add a `'`",
        );
    }
    words(
        "the text in quotes `\"` does not end on its line",
        "add a `\"`; a text of several lines stands between `\"\"\"`",
    )
}

/// Explains a missing `=`: `roughness 0.5`.
fn equals(m: &Mistake) -> Option<Words> {
    (m.key.is_empty() && !m.line.contains('=')).then_some(())?;
    let (key, value) = m.line.split_once(char::is_whitespace)?;
    let value = value.trim();
    (is_key(key) && !value.is_empty()).then_some(())?;
    if let Some(name) = suggest::clip(value).strip_suffix('{') {
        let (key, name) = (suggest::clip(key), name.trim().trim_matches('"'));
        let help = format!("write `[{key}.{name}]`");
        return words("tables begin with a header", help);
    }
    words("`=` is missing", written(key, value))
}
