//! Values that are one of a fixed set of words.

use serde_json::{Value as Json, json};

use super::{
    report::Report,
    value::{Named, Value, wrong_type},
};
use crate::declared::{Word, Words};
use crate::syntax::Node;
use crate::{range::Range, suggest};

impl<T: Words> Value for T {
    const WORDS: &'static [Word] = T::WORDS;

    fn expected() -> String {
        one_of(&names::<T>())
    }
    fn schema(_: &Range) -> Json {
        json!({ "enum": names::<T>() })
    }
    fn to_json(&self) -> Json {
        let index = T::EACH.iter().position(|value| value == self);
        index.map_or(Json::Null, |index| json!(T::WORDS[index].name))
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let names = names::<T>();
        let word = word(node, named.key, &names, report)?;
        let index = names.iter().position(|name| *name == word)?;
        T::EACH.get(index).copied()
    }
}

fn names<T: Words>() -> Vec<&'static str> {
    T::WORDS.iter().map(|word| word.name).collect()
}

/// The words as a list in prose: `"a", "b" or "c"`.
pub fn one_of(words: &[&str]) -> String {
    let quoted: Vec<_> = words.iter().map(|w| suggest::text(w)).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

/// The word that is written, if it is one of `words`; else a message that suggests the nearest one.
pub fn word(
    node: &Node,
    key: &str,
    words: &[&'static str],
    report: &mut Report,
) -> Option<&'static str> {
    let Some(written) = node.get_ref().as_str() else {
        let help = node.get_ref().as_bool().and_then(|is_on| {
            let meant = if is_on { "auto" } else { "none" };
            let word = words.iter().find(|word| **word == meant)?;
            Some(format!("write {}", suggest::text(word)))
        });
        wrong_type(node, key, &one_of(words), report).help = help;
        return None;
    };
    let known = words.iter().copied().find(|w| *w == written);
    if known.is_none() {
        let message = format!(
            "`{key}` must be {}, not {}",
            one_of(words),
            suggest::text(written)
        );
        let help = suggest::absent(written, words)
            .map(str::to_owned)
            .or_else(|| {
                let meant = suggest::nearest(written, words.iter().copied())?;
                Some(format!("did you mean {}?", suggest::text(meant)))
            });
        report.error("unknown-word", &node.span(), message).help = help;
    }
    known
}
