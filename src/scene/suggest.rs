//! "Did you mean" hints: the allowed word that is nearest to a wrong one, and advice for words of other programs.

mod filled;

use std::{collections::HashMap, sync::LazyLock};

use serde::Deserialize;

pub use self::filled::{filled, setting};

/// Words of other programs, and what to write instead.
#[derive(Deserialize)]
struct OtherPrograms {
    words: Vec<Advice>,
    keys: Vec<Advice>,
    kinds: Vec<Advice>,
    scripts: HashMap<String, Vec<(String, String)>>,
    languages: Vec<(String, Vec<String>, String)>,
    values: OtherValues,
    examples: HashMap<String, Vec<String>>,
    synonyms: HashMap<String, Vec<String>>,
}

/// Values of other programs.
#[derive(Deserialize)]
pub struct OtherValues {
    /// Width and height of pictures by their names.
    pub sizes: HashMap<String, String>,
    /// Factors of units to the unit of scene text, and its name.
    pub units: HashMap<String, (f64, String)>,
    /// Keys of lengths, meters, whose names have no unit.
    pub lengths: Vec<String>,
    /// Keys of lights by their units.
    pub light_keys: HashMap<String, String>,
    /// Usual values of keys.
    pub usual: HashMap<String, f64>,
}

/// Words with blanks between, words beside which they are unsupported, and text of the advice.
type Advice = (String, String, String);

static OTHER_PROGRAMS: LazyLock<OtherPrograms> = LazyLock::new(|| {
    toml::from_str(include_str!("other_programs.toml")).expect("every test of advice reads it")
});

/// Whether a list of words has a word.
fn lists(words: &str, word: &str) -> bool {
    words.split(' ').any(|listed| listed == word)
}

/// Advice of a list for a word beside keys, words or kinds that are there.
fn advice(
    all: &'static [Advice],
    typed: &str,
    is_there: impl Fn(&str) -> bool,
) -> Option<&'static str> {
    let lower = typed.to_lowercase();
    // Words of programs that join the parts of names in other ways: `diffuseColor`, `_MainTex`.
    let is_foreign =
        typed.starts_with('_') || typed.contains(|c: char| c == '-' || c.is_uppercase());
    let joined = |word: &str| word.replace(['_', '-'], "");
    let is_meant = |(words, beside, _): &&Advice| {
        let is_listed = |word: &str| {
            word == typed || word == lower || is_foreign && joined(word) == joined(&lower)
        };
        words.split(' ').any(is_listed) && beside.split(' ').any(&is_there)
    };
    all.iter().find(is_meant).map(|(.., help)| help.as_str())
}

/// Advice for an unsupported key in a table with the keys `known`.
pub fn absent_key(typed: &str, known: &[&str]) -> Option<&'static str> {
    advice(&OTHER_PROGRAMS.keys, typed, |key| known.contains(&key))
}

/// All rows of advice about keys.
#[cfg(test)]
fn rows() -> impl Iterator<Item = &'static Advice> {
    OTHER_PROGRAMS.keys.iter().chain(&OTHER_PROGRAMS.kinds)
}

/// Advice for an unsupported word where one of `words` is allowed.
pub fn absent(typed: &str, words: &[&str]) -> Option<&'static str> {
    advice(&OTHER_PROGRAMS.words, typed, |word| words.contains(&word))
}

/// Advice for an unsupported key in a table of this kind.
pub fn absent_of_kind(kind: &str, typed: &str) -> Option<&'static str> {
    advice(&OTHER_PROGRAMS.kinds, typed, |known| known == kind)
}

/// Advice for a word of another language or library in a script, of a kind such as `functions`.
pub fn in_script(kind: &str, typed: &str) -> Option<&'static str> {
    let mut all = OTHER_PROGRAMS.scripts.get(kind)?.iter();
    let meant = all.find(|(words, _)| lists(words, typed));
    meant.map(|(_, help)| help.as_str())
}

/// Name of the language that a text begins in, and advice.
pub fn language(begin: &str) -> Option<(&'static str, &'static str)> {
    let is_it = |prefix: &String| begin.starts_with(prefix.as_str());
    let mut all = OTHER_PROGRAMS.languages.iter();
    let found = all.find(|(_, prefixes, _)| prefixes.iter().any(is_it));
    found.map(|(name, _, help)| (name.as_str(), help.as_str()))
}

/// The key that an advice begins with, as in ``write `size`, …``.
pub fn key_of_advice(help: &str) -> Option<&str> {
    let (key, rest) = help.strip_prefix("write `")?.split_once('`')?;
    let (key, _) = key.split_once(" = ").unwrap_or((key, ""));
    (rest.is_empty() || rest.starts_with([',', ';', ':'])).then_some(key)
}

/// Values of other programs, with their counterparts in scene text.
pub fn other_values() -> &'static OtherValues {
    &OTHER_PROGRAMS.values
}

/// Values that a key may have, each for another type of the value.
pub fn examples(key: &str) -> &'static [String] {
    OTHER_PROGRAMS.examples.get(key).map_or(&[], Vec::as_slice)
}

/// A key with a value that it may have.
pub fn example_of(key: &str) -> String {
    format!(
        "`{key} = {}`",
        examples(key).first().map_or("…", String::as_str)
    )
}

/// Largest number of names of a scene that are compared with one that refers to nothing.
pub const MOST_NAMES: usize = 1000;

/// Pairs of words that are spelled alike but mean different things, and are never suggested.
const STRANGERS: &[[&str; 2]] = &[["material", "matrix"]];

/// The word of `words` that is nearest to `typed`, if any is near.
pub fn nearest<'a>(typed: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if typed.len() > 64 {
        return None;
    }
    let lower = typed.to_lowercase().replace('-', "_");
    let meant = OTHER_PROGRAMS.synonyms.get(&lower);
    let score = |word: &str| {
        let is_stem = word
            .strip_prefix(lower.as_str())
            .is_some_and(|rest| rest.starts_with('_'));
        let is_synonym = meant.is_some_and(|meant| meant.iter().any(|other| other == word));
        if is_stem || is_synonym {
            return 2.0;
        }
        if STRANGERS
            .iter()
            .any(|pair| pair.contains(&word) && pair.contains(&lower.as_str()))
        {
            return 0.0;
        }
        let longest = lower.chars().count().max(word.chars().count()).max(1);
        let edits = strsim::damerau_levenshtein(&lower, &word.to_lowercase());
        let close = 1.0 - edits as f64 / longest as f64;
        let alike = strsim::jaro_winkler(&lower, &word.to_lowercase());
        if close >= 0.6 || alike >= 0.87 {
            close + alike
        } else {
            0.0
        }
    };
    let words = words.into_iter().filter(|word| word.len() <= 64);
    let scored = words
        .map(|word| (word, score(word)))
        .filter(|(_, s)| *s > 0.0);
    // The first of equal scores wins, so that the answer does not depend on how the maximum is folded.
    scored
        .fold(None, |best: Option<(&str, f64)>, next| match best {
            Some(best) if best.1 >= next.1 => Some(best),
            _ => Some(next),
        })
        .map(|(word, _)| word)
}

/// `did you mean …?`, else the list of allowed words.
pub fn hint(typed: &str, words: &[&str], quote: impl Fn(&str) -> String, lead: &str) -> String {
    match nearest(typed, words.iter().copied()) {
        Some(word) => format!("did you mean {}?", quote(word)),
        None => {
            const MOST: usize = 24;
            let list: Vec<_> = words.iter().take(MOST).map(|w| quote(w)).collect();
            let more = if words.len() > MOST { ", …" } else { "" };
            format!("{lead} {}{more}", list.join(", "))
        }
    }
}

/// A key, formatted for messages.
pub fn key(text: &str) -> String {
    if text.contains('`') {
        return self::text(text);
    }
    format!("`{}`", clip(text))
}

/// A text value, formatted for messages.
pub fn text(text: &str) -> String {
    format!("\"{}\"", clip(text).escape_debug())
}

/// User text of any length, cut to the room of a message.
pub fn clip(text: &str) -> String {
    if text.chars().count() <= 60 {
        text.to_owned()
    } else {
        text.chars().take(59).chain(['…']).collect()
    }
}
