//! Doc comments of `desc.rs` and its submodules, taken from their source: the texts of the manual.

use std::sync::LazyLock;

static SOURCE: &str = concat!(
    include_str!("../desc.rs"),
    include_str!("../desc/animation.rs"),
    include_str!("../desc/camera.rs"),
    include_str!("../desc/decal.rs"),
    include_str!("../desc/environment.rs"),
    include_str!("../desc/hierarchy.rs"),
    include_str!("../desc/image.rs"),
    include_str!("../desc/light.rs"),
    include_str!("../desc/material.rs"),
    include_str!("../desc/motion.rs"),
    include_str!("../desc/box_faces.rs"),
    include_str!("../desc/near_far.rs"),
    include_str!("../desc/outline.rs"),
    include_str!("../desc/pattern.rs"),
    include_str!("../desc/probe.rs"),
    include_str!("../desc/project.rs"),
    include_str!("../desc/reflection.rs"),
    include_str!("../desc/scatter.rs"),
    include_str!("../desc/shape.rs"),
    include_str!("../desc/stage.rs"),
    include_str!("../desc/track.rs")
);

/// Doc comment of one type, variant or field.
#[derive(Debug)]
struct Comment {
    item: String,
    variant: Option<String>,
    field: Option<String>,
    text: String,
}

static COMMENTS: LazyLock<Vec<Comment>> = LazyLock::new(|| extract(SOURCE));

/// Reads rustfmt-formatted source, where indentation tells the depth: types at 0, fields and variants at 4,
/// fields of variants at 8.
fn extract(source: &str) -> Vec<Comment> {
    let (mut all, mut text) = (Vec::new(), Vec::new());
    let (mut item, mut variant) = (String::new(), None);
    for line in source.lines() {
        let code = line.trim_start();
        if let Some(comment) = code.strip_prefix("///") {
            text.push(comment.trim().to_owned());
            continue;
        }
        if code.starts_with("#[") {
            continue; // an attribute between a comment and its item
        }
        let mut lines = std::mem::take(&mut text);
        let indent = line.len() - code.len();
        let word = |code: &str| -> String {
            code.chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect()
        };
        let field = word(code.strip_prefix("pub ").unwrap_or(code));
        let name = ["pub struct ", "pub enum "]
            .iter()
            .find_map(|p| code.strip_prefix(p));
        let is_variant = indent == 4 && field.starts_with(char::is_uppercase);
        if let Some(name) = name {
            (item, variant) = (word(name), None);
        } else if lines.is_empty() {
            continue;
        } else if is_variant {
            variant = Some(field.clone());
        }
        let variant = variant.clone().filter(|_| is_variant || indent == 8);
        for (key, text) in split_keys(&mut lines) {
            all.push(Comment {
                item: item.clone(),
                variant: variant.clone(),
                field: Some(key),
                text,
            });
        }
        let field = (name.is_none() && !is_variant).then_some(field);
        let text = lines.join(" ").trim().to_owned();
        all.push(Comment {
            item: item.clone(),
            variant,
            field,
            text,
        });
    }
    all
}

/// Takes the lines ``- `key`: text`` out of a comment; lines that follow one belong to it.
fn split_keys(lines: &mut Vec<String>) -> Vec<(String, String)> {
    let first = lines
        .iter()
        .position(|line| line.starts_with("- `"))
        .unwrap_or(lines.len());
    let mut keys: Vec<(String, String)> = Vec::new();
    for line in lines.drain(first..) {
        let key = line
            .strip_prefix("- `")
            .and_then(|rest| rest.split_once("`: "));
        match (key, keys.last_mut()) {
            (Some((key, text)), _) => keys.push((key.to_owned(), sentence(text))),
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

/// Doc comment of a type.
pub fn of_type(name: &str) -> Option<&'static str> {
    let is_it = |c: &&Comment| c.item == name && c.variant.is_none() && c.field.is_none();
    COMMENTS.iter().find(is_it).map(|c| c.text.as_str())
}

/// Doc comment of the variant that scene text writes as `word`: the comment that begins with it, in quotes.
pub fn of_word(types: &[&str], word: &str) -> Option<&'static str> {
    variant(types, word).map(|c| c.text.as_str())
}

fn variant(types: &[&str], word: &str) -> Option<&'static Comment> {
    let lead = format!("`\"{word}\"`");
    let of_types = |c: &&Comment| types.contains(&c.item.as_str());
    COMMENTS
        .iter()
        .filter(of_types)
        .find(|c| c.field.is_none() && c.text.starts_with(&lead))
}

/// Doc comment of a key of a table that is described by `types`; with `word`, of a key of that variant.
///
/// Candidates, in this order: the field with the key's name, the key's line in the list of another comment, the
/// comment that begins with the key in code marks.
pub fn of_key(types: &[&str], word: Option<&str>, key: &str) -> Option<&'static str> {
    let variant = word
        .and_then(|word| variant(types, word))
        .map(|c| c.variant.clone());
    let of_types: Vec<_> = COMMENTS
        .iter()
        .filter(|c| types.contains(&c.item.as_str()))
        .collect();
    let has_name = |c: &&&Comment| c.field.as_deref() == Some(key);
    let in_variant = |c: &&&Comment| variant.as_ref().is_none_or(|v| c.variant == *v);
    let begins = |c: &&&Comment| {
        let rest = c.text.trim_start_matches(['`', '[']).strip_prefix(key);
        let whole = |r: &str| !r.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        c.text.starts_with('`') && rest.is_some_and(whole)
    };
    let found = of_types.iter().filter(in_variant).find(has_name);
    found
        .or_else(|| of_types.iter().find(begins))
        .map(|c| c.text.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_found_by_field_by_list_and_by_beginning() {
        let fov = of_key(&["CameraDesc"], None, "fov_deg").expect("a field");
        assert!(fov.starts_with("Vertical field of view"), "{fov}");
        let instance = of_key(&["SceneDesc"], None, "instance").expect("begins so");
        assert!(instance.starts_with("`[[instance]]`"), "{instance}");
        let types = ["InstanceDesc", "PlacementDesc"];
        let quat = of_key(&types, None, "rotation_quat").expect("in a list");
        assert!(quat.starts_with("The same as a quaternion"), "{quat}");
        let cone = of_key(&["ShapeDesc"], Some("cone"), "radius").expect("a field of a variant");
        assert!(cone.starts_with("Radius of the foot"), "{cone}");
        assert_eq!(of_key(&["CameraDesc"], None, "fov"), None);
    }
}
