//! Code actions: advice of messages, done by the editor.

use std::ops::Range;

use serde_json::{Value, json};

use reflet_scene::{
    diagnostic::{Diagnostic, Source},
    toml_text::toml_text,
};

use super::position::{offset, range};

/// Words that lead to a name which is most likely meant.
const MEANT: &str = "did you mean ";
/// Name of messages about text that is no TOML.
const SYNTAX: &str = "toml-syntax";
/// Beginnings of comments of other languages.
const COMMENTS: [&str; 4] = ["//", "/*", "--", "<!--"];

/// An edit: the replaced range and its new text.
type Edit = (Range<usize>, String);

/// Actions for messages of a request whose help asks about a name, or says what to write.
pub fn actions(file: &Source, uri: &str, params: &Value) -> Vec<Value> {
    let messages = params["context"]["diagnostics"].as_array();
    let action = |message: &Value| {
        let text = message["message"].as_str()?;
        let (_, help) = text.split_once("\nhelp: ")?;
        let [start, end] = ["start", "end"].map(|end| offset(&file.text, &message["range"][end]));
        let place = Place {
            text: &file.text,
            at: start..end.max(start),
            is_syntax: message["code"] == SYNTAX,
        };
        let (at, new) = place.mended(help)?;
        Some(json!({
            "title": format!("Write {}", new.trim_end()),
            "kind": "quickfix",
            "isPreferred": true,
            "diagnostics": [message],
            "edit": { "changes": { uri: [{ "range": range(&file.text, &at), "newText": new }] } },
        }))
    };
    messages.into_iter().flatten().filter_map(action).collect()
}

/// The edit that does what the help of a message says: the replaced text, its range and the new text. `None` where the help
/// leaves a choice.
pub fn quick_fix(message: &Diagnostic) -> Option<Value> {
    let text = &message.span.source.as_ref()?.text;
    let place = Place {
        text,
        at: message.span.range.clone(),
        is_syntax: message.name == SYNTAX,
    };
    let (at, new) = place.mended(message.help.as_ref()?)?;
    Some(json!({ "old": &text[at.clone()], "range": range(text, &at), "new": new }))
}

/// Place of a message in a text.
struct Place<'t> {
    text: &'t str,
    at: Range<usize>,
    /// Whether the text is no TOML there, so that the place may be a part of the value.
    is_syntax: bool,
}

impl Place<'_> {
    fn mended(&self, help: &str) -> Option<Edit> {
        let meant = meant(help, self.now()).map(|name| (self.at.clone(), name));
        meant
            .or_else(|| self.statement(help))
            .or_else(|| self.value(help))
    }

    fn now(&self) -> &str {
        &self.text[self.at.clone()]
    }

    /// Line of the place, without spaces at its ends.
    fn line(&self) -> Range<usize> {
        let start = self.text[..self.at.start]
            .rfind('\n')
            .map_or(0, |at| at + 1);
        let end = self.text[self.at.start..].find('\n');
        self.trimmed(start..end.map_or(self.text.len(), |at| self.at.start + at))
    }

    /// A range without spaces at its ends.
    fn trimmed(&self, all: Range<usize>) -> Range<usize> {
        let text = &self.text[all.clone()];
        let start = all.start + text.len() - text.trim_start().len();
        start..start + text.trim().len()
    }

    /// The value that a help text says to write, such as `write 0.5, in meters`, in place of the message's value.
    fn value(&self, help: &str) -> Option<Edit> {
        let (_, rest) = help.split_once("write ")?;
        let new = first_value(rest)?;
        if let Some(old) = rest[new.len()..].strip_prefix(" for ") {
            let start = self.at.start + self.now().find(old)?;
            return Some((start..start + old.len(), new.to_owned()));
        }
        if !self.is_syntax {
            return is_value(self.now()).then(|| (self.at.clone(), new.to_owned()));
        }
        let line = self.line();
        let before_place = line.start..self.at.start.clamp(line.start, line.end);
        let begin = line.start + self.text[line.clone()].find('=')? + 1;
        let breaks = |c: char| ",[]{}=#".contains(c);
        let is_inside = |c: char| !(c.is_whitespace() || breaks(c));
        let start = self.text[before_place.clone()].rfind(breaks);
        let start = start.map_or(line.start, |at| line.start + at + 1);
        let end = self.text[before_place.end..line.end].find(breaks);
        let end = end.map_or(line.end, |at| before_place.end + at);
        let element = self.trimmed(start..end);
        let whole = self.trimmed(begin..line.end);
        // A comment behind the value stays.
        let length = self.text[whole.clone()].find(" #").unwrap_or(whole.len());
        let whole = self.trimmed(whole.start..whole.start + length);
        let mends = |at: &Range<usize>| {
            let [before, after] = [line.start..at.start, at.end..line.end];
            let [before, after] = [&self.text[before], &self.text[after]];
            let is_part = before.ends_with(is_inside) || after.starts_with(is_inside);
            let mended = [before, new, after].concat();
            !at.is_empty() && at.start >= begin && !is_part && is_toml(&mended)
        };
        let at = [self.at.clone(), element, whole].into_iter().find(mends)?;
        Some((at, new.to_owned()))
    }

    /// The line, table header, comment or value of the same key that a help text says to write, such as
    /// ``write `metallic = 1` ``.
    fn statement(&self, help: &str) -> Option<Edit> {
        let (_, rest) = help.split_once("write `")?;
        let (new, _) = rest.split_once('`')?;
        if new.contains('…') || !is_toml(new) {
            return None;
        }
        let line = self.line();
        let old = &self.text[line.clone()];
        if new.starts_with('#') {
            let begins = |from: &usize| {
                let rest = self.text.get(*from..line.end).unwrap_or_default();
                COMMENTS.iter().any(|sign| rest.starts_with(sign))
            };
            let from = [self.at.start, line.start].into_iter().find(begins)?;
            return Some((from..line.end, new.to_owned()));
        }
        if new.starts_with('[') {
            let letters = |text: &str| text.replace(|c: char| !c.is_alphanumeric(), "");
            let is_it = old.starts_with('[') && letters(old) == letters(new);
            return is_it.then(|| (line, new.to_owned()));
        }
        let (key, value) = new.split_once(" = ")?;
        let ends = |c: char| !(c.is_alphanumeric() || "_-.".contains(c));
        if self.is_syntax {
            let is_own = old.strip_prefix(key)?.starts_with(ends) && !old.contains(" #");
            return is_own.then(|| (line, new.to_owned()));
        }
        if self.at == (0..0) {
            // A key that the whole text lacks.
            return Some((self.at.clone(), format!("{new}\n")));
        }
        let before = self.text[line.start.min(self.at.start)..self.at.start].trim_end();
        let before = before.strip_suffix('=')?.trim_end().strip_suffix(key)?;
        let is_own = (before.is_empty() || before.ends_with(ends)) && is_value(self.now());
        is_own.then(|| (self.at.clone(), value.to_owned()))
    }
}

/// The name that a help text asks about, in the quotes of the text that it replaces.
fn meant(help: &str, now: &str) -> Option<String> {
    let (_, rest) = help.split_once(MEANT)?;
    let quote = rest.chars().next().filter(|c| "`\"".contains(*c))?;
    let (name, _) = rest[1..].split_once(quote)?;
    match now.starts_with(['"', '\'']) {
        // The path in `remove` keeps its first part.
        true => Some(toml_text(name)),
        // A text is no name: the place is the key of a map in a script.
        false => (quote == '`').then(|| name.to_owned()),
    }
}

/// The value that a text begins with, unless it is the first one of several.
fn first_value(text: &str) -> Option<&str> {
    let is_number = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    let end = match text.chars().next()? {
        '"' => 2 + text[1..].find('"')?,
        '[' | '{' => closing(text)?,
        c if c.is_ascii_digit() || c == '-' => text.find(|c| !is_number(c)).unwrap_or(text.len()),
        _ => {
            let mut words = ["true", "false"].into_iter();
            words.find(|word| text.starts_with(word))?.len()
        }
    };
    let (value, rest) = text.split_at(end);
    let rest = rest.trim_start_matches([',', ' ']);
    let rest = rest.strip_prefix("or ").unwrap_or(rest);
    let goes_on = rest.starts_with(|c: char| c.is_ascii_digit() || "\"[{-`".contains(c))
        || rest.starts_with("numbers");
    (!goes_on && is_value(value)).then_some(value)
}

/// End of the bracket that a text begins with.
fn closing(text: &str) -> Option<usize> {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '[' | '{' => depth += 1,
            ']' | '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(at + 1);
        }
    }
    None
}

fn is_toml(text: &str) -> bool {
    toml::from_str::<toml::Table>(text).is_ok()
}

fn is_value(text: &str) -> bool {
    is_toml(&format!("x = {text}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A text whose message stands at the part between `«` and `»`, mended as a help text says.
    fn mended(marked: &str, code: &str, help: &str) -> Option<String> {
        let (before, rest) = marked.split_once('«').expect("a start");
        let (now, after) = rest.split_once('»').expect("an end");
        let text = [before, now, after].concat();
        let place = Place {
            text: &text,
            at: before.len()..before.len() + now.len(),
            is_syntax: code == SYNTAX,
        };
        let (at, new) = place.mended(help)?;
        Some([&text[..at.start], &new, &text[at.end..]].concat())
    }

    /// Lines of `mended.txt`: name of the message, text with its place, help, and the mended text; nothing where the help
    /// leaves a choice or is about another place.
    #[test]
    fn help_that_says_what_to_write_mends_its_place() {
        for case in include_str!("tests/mended.txt").lines() {
            let (code, rest) = case.split_once(": ").expect("a name");
            let (marked, rest) = rest.split_once(" => ").expect("a text");
            let (help, wanted) = rest.split_once(" =>").expect("a help");
            let found = mended(&marked.replace("\\n", "\n"), code, help);
            let wanted = wanted
                .strip_prefix(' ')
                .map(|text| text.replace("\\n", "\n"));
            assert_eq!(found, wanted, "{case}");
        }
    }
}
