//! Forms that mistakes have, as rows of a file: the part of the text, a regular expression, the message, and advice.

use std::{borrow::Cow, ops::Range, sync::LazyLock};

use regex::{Captures, Regex};
use serde::Deserialize;

use crate::suggest;

#[derive(Deserialize)]
struct Rows {
    forms: Vec<[String; 4]>,
}

/// A form that mistakes have.
pub struct Form {
    /// Name of the part of the text.
    pub part: String,
    /// Expression as it is written in the file.
    pub written: String,
    pattern: Regex,
    message: String,
    help: String,
}

static FORMS: LazyLock<Vec<Form>> = LazyLock::new(|| of_file(include_str!("forms.toml")));

/// Message, perhaps empty, and advice about a text of a kind: `part` names it as the file forms.toml does.
pub fn explained(part: &str, text: &str) -> Option<(String, String)> {
    found(part, text).map(|(_, message, help)| (message, help))
}

/// Place of a mistake in a text, message and advice.
pub fn found(part: &str, text: &str) -> Option<(Range<usize>, String, String)> {
    let part_of = |name: &str| (name == part).then(|| text.into());
    FORMS.iter().find_map(|form| form.found(part_of))
}

/// Forms of a file of this program.
pub fn of_file(text: &str) -> Vec<Form> {
    let rows: Rows = toml::from_str(text).expect("tests read it");
    let form = |[part, written, message, help]: [String; 4]| Form {
        pattern: pattern(&written),
        part,
        written,
        message,
        help,
    };
    rows.forms.into_iter().map(form).collect()
}

/// An expression as a file of forms has it.
pub fn pattern(written: &str) -> Regex {
    let pattern = written
        .replace(
            "<n>",
            r"(?:0x[0-9A-Fa-f]+|[+-]?(?:[0-9][0-9_]*\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)",
        )
        .replace("<k>", r"[\p{Alphabetic}\p{N}_.\-]")
        .replace(r"\w", r"[\p{Alphabetic}\p{N}_]")
        .replace(r"\b", r"(?-u:\b)");
    Regex::new(&pattern).expect("tests read it")
}

/// A place in a message that a text of the user fills.
static SLOT: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"\{([a-z]+)(?::([a-z]+))?\}").expect("it is right"));

impl Form {
    /// Place in the part of the text, message and advice, if it has this form; `part_of` gives a part by its name.
    pub fn found<'t>(
        &self,
        part_of: impl Fn(&str) -> Option<Cow<'t, str>>,
    ) -> Option<(Range<usize>, String, String)> {
        let part = part_of(&self.part)?;
        let found = self.pattern.captures(&part)?;
        let slot = |slot: &Captures| {
            let group = found.name(&slot[1]).map(|group| group.as_str().into());
            let text = group.or_else(|| part_of(&slot[1])).unwrap_or_default();
            in_words(&text, slot.get(2).map_or("", |form| form.as_str()))
        };
        let fill = |template: &str| SLOT.replace_all(template, slot).into_owned();
        let at = found
            .name("at")
            .or(found.get(0))
            .map_or(0..0, |at| at.range());
        Some((at, fill(&self.message), fill(&self.help)))
    }
}

/// A text of the user in a message.
fn in_words(text: &str, form: &str) -> String {
    let joined = |parts: Vec<&str>| suggest::clip(&parts.join(", "));
    match form {
        "key" => suggest::key(text),
        "text" => suggest::text(text),
        "list" => joined(text.split([',', ';']).map(str::trim).collect()),
        "values" => {
            let entries = text.split(',').filter_map(|entry| entry.split_once('='));
            joined(entries.map(|(_, value)| value.trim()).collect())
        }
        "spaced" => joined(text.split_whitespace().collect()),
        _ => suggest::clip(text.trim()),
    }
}
