//! Texts of the manual: the comments of the types that describe scene text.

use crate::declared::TypeDoc;

/// Text about a type, a variant, a field or a key.
struct Text {
    variant: Option<&'static str>,
    key: Option<&'static str>,
    text: String,
}

/// Texts of a type: its comments, each after the keys that it lists.
fn texts(doc: &TypeDoc) -> impl Iterator<Item = Text> {
    doc.comments.iter().flat_map(|comment| {
        let mut lines: Vec<_> = comment.lines.iter().map(|line| line.trim()).collect();
        let keys = split_keys(&mut lines).into_iter();
        let keys = keys.map(|(key, text)| (Some(key), text));
        let own = (comment.field, lines.join(" ").trim().to_owned());
        let variant = comment.variant;
        keys.chain([own])
            .map(move |(key, text)| Text { variant, key, text })
    })
}

/// Lines of a comment as one text.
pub fn joined(lines: &[&str]) -> String {
    let lines: Vec<_> = lines.iter().map(|line| line.trim()).collect();
    lines.join(" ")
}

/// Takes the lines ``- `key`: text`` out of a comment; lines that follow one belong to it.
fn split_keys<'a>(lines: &mut Vec<&'a str>) -> Vec<(&'a str, String)> {
    let first = lines.iter().position(|line| line.starts_with("- `"));
    let mut keys: Vec<(&str, String)> = Vec::new();
    for line in lines.drain(first.unwrap_or(lines.len())..) {
        let key = line
            .strip_prefix("- `")
            .and_then(|rest| rest.split_once("`: "));
        match (key, keys.last_mut()) {
            (Some((key, text)), _) => keys.push((key, sentence(text))),
            (None, Some(last)) => last.1 = format!("{} {line}", last.1),
            (None, None) => {}
        }
    }
    keys
}

/// The text with its first letter in upper case.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Comment of a type.
pub fn of_type(doc: &TypeDoc) -> Option<String> {
    let is_it = |text: &Text| text.variant.is_none() && text.key.is_none();
    texts(doc).find(is_it).map(|text| text.text)
}

/// Comment of the variant that scene text writes as `word`: the comment that begins with it, in quotes.
pub fn of_word(docs: &[&TypeDoc], word: &str) -> Option<String> {
    variant(docs, word).map(|text| text.text)
}

fn variant(docs: &[&TypeDoc], word: &str) -> Option<Text> {
    let lead = format!("`\"{word}\"`");
    let mut all = docs.iter().flat_map(|doc| texts(doc));
    all.find(|text| text.key.is_none() && text.text.starts_with(&lead))
}

/// Comment of a key of a table that is described by `docs`; with `word`, of a key of that variant.
///
/// Candidates, in this order: the field with the key's name, the key's line in the list of another comment, the
/// comment that begins with the key in code marks.
pub fn of_key(docs: &[&TypeDoc], word: Option<&str>, key: &str) -> Option<String> {
    let variant = word
        .and_then(|word| variant(docs, word))
        .map(|text| text.variant);
    let mut all: Vec<_> = docs.iter().flat_map(|doc| texts(doc)).collect();
    let has_name = |text: &Text| text.key == Some(key);
    let in_variant = |text: &Text| variant.is_none_or(|v| text.variant == v);
    let begins = |text: &Text| {
        let rest = text.text.trim_start_matches(['`', '[']).strip_prefix(key);
        let whole = |r: &str| !r.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        text.text.starts_with('`') && rest.is_some_and(whole)
    };
    let named = all
        .iter()
        .position(|text| in_variant(text) && has_name(text));
    let found = named.or_else(|| all.iter().position(begins))?;
    Some(all.swap_remove(found).text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        declared::Described,
        desc::{CameraDesc, InstanceDesc, PlacementDesc, SceneDesc, ShapeDesc},
    };

    #[test]
    fn comments_are_found_by_field_by_list_and_by_beginning() {
        let fov = of_key(&[CameraDesc::DOC], None, "fov_deg").expect("a field");
        assert!(fov.starts_with("Vertical field of view"), "{fov}");
        let instance = of_key(&[SceneDesc::DOC], None, "instance").expect("begins so");
        assert!(instance.starts_with("`[[instance]]`"), "{instance}");
        let types = [InstanceDesc::DOC, PlacementDesc::DOC];
        let quat = of_key(&types, None, "rotation_quat").expect("in a list");
        assert!(quat.starts_with("The same as a quaternion"), "{quat}");
        let cone = of_key(&[ShapeDesc::DOC], Some("cone"), "radius").expect("a field of a variant");
        assert!(cone.starts_with("Radius of the foot"), "{cone}");
        assert_eq!(of_key(&[CameraDesc::DOC], None, "fov"), None);
    }
}
