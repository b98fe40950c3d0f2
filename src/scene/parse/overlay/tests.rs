//! Tests of keys that exclude each other in the layers of a scene.

use super::*;
use crate::{parse::recorded_keys, syntax::SyntaxTree};

/// Keys that are left where `above` is laid over `below`.
fn left(place: Below, below: &str, above: &str) -> Vec<String> {
    let tree = |text: &str| SyntaxTree::parse(text).root().clone();
    let mut below = tree(below);
    overlay_at(Some(place), &mut below, tree(above));
    below.keys().map(|key| key.get_ref().clone()).collect()
}

#[test]
fn a_key_replaces_those_that_its_reader_excludes() {
    let mut tried = 0;
    for section in recorded_keys() {
        let place = Below::Table(section);
        let plain = (section.rules.iter()).map(|rule| (String::new(), &[][..], rule));
        let of_kinds = section.variants.iter().flat_map(|v| {
            let kind = format!("{} = \"{}\"\n", v.key, v.word);
            (v.rules.iter()).map(move |rule| (kind.clone(), &v.needing[..], rule))
        });
        for (kind, needing, rule) in plain.chain(of_kinds) {
            let needing = || section.needing.iter().chain(needing);
            for (i, group) in rule.groups.iter().enumerate() {
                let others = (rule.groups.iter().enumerate()).filter(|(j, _)| *j != i);
                for (key, other) in group.iter().flat_map(|key| {
                    let others = others.clone().flat_map(|(_, group)| group);
                    others.map(move |other| (*key, *other))
                }) {
                    let needing = needing().filter(|needing| needing.key == other);
                    let gone = needing.flat_map(|needing| needing.others).chain([&other]);
                    let below: String = gone.map(|key| format!("{key} = 1\n")).collect();
                    let mut kept = left(place, &format!("{kind}{below}"), &format!("{key} = 2"));
                    kept.retain(|left| !kind.starts_with(left.as_str()));
                    assert_eq!(kept, [key], "{kind}{below} under {key}");
                    let both = left(place, &kind, &format!("{key} = 1\n{other} = 2"));
                    let stays = |key: &str| both.iter().any(|left| left == key);
                    assert!(stays(key) && stays(other), "{kind}{key} beside {other}");
                    tried += 1;
                }
            }
        }
    }
    assert!(tried > 50, "{tried}");
}
