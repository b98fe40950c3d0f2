//! The manual of the scene text, one text here and the pages of `docs/scene`: keys, types, ranges and
//! defaults as the reader asks for them, meanings as the types of descriptions comment them.

mod comments;
mod pages;

use std::fmt::Write as _;

pub use self::pages::{Page, pages};
use super::{
    parse::{Form, KeyRecord, SectionRecord, recorded_keys, recorded_project_keys},
    table::key_recorder::Rule,
};

/// A scene that shows most keys.
pub const EXAMPLE: &str = include_str!("manual/example.toml");

const INTRODUCTION: &str = include_str!("manual/introduction.md");

/// Function from the name of a type of `desc.rs` to the address of its section, for links from keys that
/// take such a table; `None` for no link.
type Link<'a> = &'a dyn Fn(&str) -> Option<String>;

/// The whole manual as one Markdown text, for a terminal.
pub fn manual() -> String {
    let mut out = introduction();
    for section in all_sections() {
        describe_section(&mut out, section, 2, &|_| None);
    }
    out
}

/// All tables of scenes and of projects.
fn all_sections() -> impl Iterator<Item = &'static SectionRecord> {
    recorded_keys().iter().chain(recorded_project_keys())
}

fn introduction() -> String {
    INTRODUCTION.replace("EXAMPLE\n", EXAMPLE)
}

/// Comment of a table's type, which says what the table is for.
pub fn section_text(section: &SectionRecord) -> String {
    comments::of_type(section.docs[0]).unwrap_or_default()
}

/// Comment of the variant of a table whose `kind` is `word`.
pub fn variant_text(section: &SectionRecord, word: &str) -> String {
    comments::of_word(&section.docs, word).unwrap_or_default()
}

/// Comment of a key, followed by the comments of its allowed words, if it takes one of a set.
pub fn key_text(section: &SectionRecord, word: Option<&str>, key: &KeyRecord) -> String {
    let text = comments::of_key(&section.docs, word, key.name).unwrap_or_default();
    let mut text = without_lead(key.text.as_deref().unwrap_or(&text), key.name);
    for word in key.words {
        let _ = write!(
            text,
            "\n`\"{}\"`: {}",
            word.name,
            comments::joined(word.lines)
        );
    }
    text
}

/// Writes a section with a heading of `level`, 1 to 5, and its variants one level below.
fn describe_section(out: &mut String, section: &SectionRecord, level: usize, link: Link) {
    let heading = section.heading;
    let marks = "#".repeat(level);
    let _ = match section.type_name {
        "SceneDesc" => write!(out, "\n{marks} {heading}\n"),
        _ => write!(out, "\n{marks} `{heading}`\n"),
    };
    let text = without_lead(&section_text(section), heading);
    if !text.is_empty() {
        let _ = write!(out, "\n{text}\n");
    }
    for (group, keys) in section.groups().filter(|(_, keys)| !keys.is_empty()) {
        if !group.is_empty() {
            let _ = write!(out, "\n{marks}# {group}\n");
        }
        describe_keys(out, section, None, keys, &section.rules, link);
    }
    for variant in &section.variants {
        let _ = write!(out, "\n{marks}# `{} = \"{}\"`\n", variant.key, variant.word);
        let lead = format!("\"{}\"", variant.word);
        let text = without_lead(&variant_text(section, variant.word), &lead);
        if !text.is_empty() {
            let _ = write!(out, "\n{text}\n");
        }
        let (word, keys) = (Some(variant.word), &variant.keys);
        describe_keys(out, section, word, keys, &variant.rules, link);
    }
}

/// The comment without the code that it begins with, which the heading or the key already says.
fn without_lead(text: &str, code: &str) -> String {
    let rest = text
        .strip_prefix(&format!("`{code}`"))
        .filter(|r| !r.starts_with(','));
    comments::sentence(rest.unwrap_or(text).trim_start_matches([':', '.', ' ']))
}

fn describe_keys<'a>(
    out: &mut String,
    section: &SectionRecord,
    word: Option<&str>,
    keys: impl IntoIterator<Item = &'a KeyRecord>,
    rules: &[Rule],
    link: Link,
) {
    out.push_str("\n| key | value | default | meaning |\n|---|---|---|---|\n");
    for key in keys {
        let default = match &key.default {
            Some(value) => format!("`{}`", value.to_string().replace(',', ", ")),
            None if key.required => "required".into(),
            None => one_of(rules, key.name),
        };
        let meaning = key_text(section, word, key).replace('\n', "<br>");
        let cells = [
            format!("`{}`", key.name),
            value_text(key, link),
            default,
            meaning,
        ];
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        let _ = writeln!(out, "| {} |", cells.join(" | "));
    }
}

/// Words for a key of which, or of others, a table must have one; empty for any other key.
fn one_of(rules: &[Rule], key: &str) -> String {
    let names = |rule: &Rule| rule.groups.iter().map(|group| group[0]).collect::<Vec<_>>();
    let required = (rules.iter()).filter(|rule| rule.required && rule.groups.len() > 1);
    let keys = required.map(names).find(|keys| keys.contains(&key));
    keys.map_or_else(String::new, |keys| {
        format!("exactly one of `{}`", keys.join("`, `"))
    })
}

/// Type and range of a key, in words.
fn value_text(key: &KeyRecord, link: Link) -> String {
    let linked = |words: &str, type_name: &str| match link(type_name) {
        Some(address) => format!("[{words}]({address})"),
        None => words.to_owned(),
    };
    let form = |form: &Form| match form {
        Form::Value(expected, _) if key.range.is_empty() => expected.clone(),
        Form::Value(expected, _) => format!("{expected}, {}", key.range),
        Form::Table(name) => linked("a table", name),
        Form::Entries(name) => linked("tables with names", name),
        Form::List(name) => linked("a list of tables", name),
    };
    key.forms.iter().map(form).collect::<Vec<_>>().join(", or ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_variant_and_key_has_its_comment() {
        for section in all_sections() {
            let name = section.type_name;
            assert!(!section_text(section).is_empty(), "{name} has no comment");
            let plain = section.keys.iter().map(|key| (None, key));
            let of_variants = section.variants.iter().flat_map(|v| {
                assert!(
                    !variant_text(section, v.word).is_empty(),
                    "{name} {}",
                    v.word
                );
                v.keys.iter().map(|key| (Some(v.word), key))
            });
            for (word, key) in plain.chain(of_variants) {
                let text = key_text(section, word, key);
                assert!(!text.is_empty(), "`{}` of {name} has no comment", key.name);
                assert!(
                    !text.ends_with('\n'),
                    "a word of `{}` has no comment",
                    key.name
                );
            }
        }
    }

    /// The prose of `desc.rs` repeats ranges and defaults for readers of the source.
    #[test]
    fn comments_agree_with_the_ranges_and_defaults_that_are_read() {
        for section in all_sections() {
            let plain = section.keys.iter().map(|key| (None, key));
            let of_variants = section.variants.iter();
            let of_variants = of_variants.flat_map(|v| v.keys.iter().map(|k| (Some(v.word), k)));
            for (word, key) in plain.chain(of_variants) {
                let text = key_text(section, word, key);
                let place = format!("`{}` of {}: {text}", key.name, section.type_name);
                let depends_on_another = key.name == "inner_deg";
                if !depends_on_another {
                    assert!(
                        text.contains(&key.range),
                        "{place}\nshould say {:?}",
                        key.range
                    );
                }
                if let Some((_, written)) = text.split_once("Default ") {
                    let Some(default) = &key.default else {
                        continue;
                    };
                    let default = default.to_string().replace(',', ", ");
                    let by_name = ["white", "black"]
                        .iter()
                        .any(|color| written.starts_with(color));
                    assert!(
                        by_name || written.trim_start_matches('`').starts_with(&default),
                        "{place}\nreads {default}"
                    );
                }
            }
        }
    }

    #[test]
    fn manual_example_parses_without_errors() {
        let (scene, warnings) =
            crate::stages::Scene::from_text(EXAMPLE, "example.toml".as_ref(), &[]).unwrap();
        assert_eq!(warnings, []);
        assert_eq!(scene.instances.len(), 4);
    }
}
