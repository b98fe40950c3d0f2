//! Syntax of other languages, and its counterpart in Rhai.

use crate::{diagnostic::Span, suggest};

/// Message and advice about a word of another language.
pub fn word(word: &str) -> Option<(String, Option<String>)> {
    let help = suggest::script_word(word)?;
    let message = format!("there is no {} in Rhai", suggest::key(word));
    Some((message, Some(help.to_owned())))
}

/// Message and advice about a sign of another language, by the text around the place of a syntax error.
pub fn sign(at: &Span) -> Option<(String, Option<String>)> {
    let text = &at.source.as_ref()?.text;
    let start = at.range.start;
    let line = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let (before, after) = (&text[line..start], text[start..].lines().next()?);
    let name = |text: &str| text.chars().all(|c| c.is_alphanumeric() || c == '_');
    let explained = |message: &str, help: &str| Some((message.to_owned(), Some(help.to_owned())));
    if after.starts_with('\'') {
        let help = "write \"abc\"; single quotes hold one character";
        return explained(
            "texts stand in double quotes `\"`, not in single ones `'`",
            help,
        );
    }
    if after.starts_with('=') && !after.starts_with("==") {
        let entry = before.rsplit(['{', ',']).next().unwrap_or(before).trim();
        if name(entry) && !entry.is_empty() && before.contains("#{") {
            let help = format!("write `{entry}: …`");
            return explained("in a map stands `:`, not `=`", &help);
        }
    }
    if after.starts_with('?') {
        let help = "write `if a { 1 } else { 2 }`, which has a value";
        return explained("there is no `? :` in Rhai", help);
    }
    if after.starts_with(':') {
        let (left, key) = before.rsplit_once(['{', ' ', ',']).unwrap_or(("", before));
        if name(key) && left.trim_end().ends_with("let") {
            let help = format!("write `let {key} = …`");
            let message = format!("variables have no types in Rhai, and `{key}` has one");
            return explained(&message, &help);
        }
        if name(key.trim()) && before.contains('{') && !before.contains("#{") {
            return explained("a map begins with `#{`", "write `#{ a: 1 }`");
        }
    }
    let word = after.find(|c: char| !(c.is_alphanumeric() || c == '_'));
    let is_key = word.is_some_and(|end| end > 0 && after[end..].trim_start().starts_with(':'));
    let opens = before.trim_end();
    if is_key && opens.ends_with('{') && !opens.ends_with("#{") {
        return explained("a map begins with `#{`", "write `#{ a: 1 }`");
    }
    if opens
        .strip_suffix('(')
        .is_some_and(|b| b.trim_end().ends_with("for"))
    {
        return explained(
            "`for` goes over a range or a list",
            "write `for i in 0..3 { … }`",
        );
    }
    if after.starts_with("++") || after.starts_with("--") {
        return explained("there is no `++` in Rhai", "write `x += 1`");
    }
    None
}
