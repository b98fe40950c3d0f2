//! Words of keys that take what exists: groups of light, entries to remove, properties that decals change.

use std::{collections::BTreeSet, sync::Arc};

use super::{
    names::names,
    outline::{Part, words},
    scopes::with_scopes,
};
use crate::scene::{
    desc::{DecalChanges, LightGroup},
    diagnostic::Source,
    parse::entry_kinds::ENTRY_KINDS,
};

/// Words for the value of a key in a table, where no list of the manual has them.
pub fn known_words(file: &Arc<Source>, table: &[String], key: &str) -> Vec<String> {
    let table: Vec<&str> = table.iter().map(String::as_str).collect();
    match (key, table.as_slice()) {
        ("changes", ["decal", _] | ["variant", _, "decal", _]) => {
            DecalChanges::WORDS.map(str::to_owned).to_vec()
        }
        ("light_group", _) => light_groups(file),
        ("remove", []) => entries(file, true),
        ("remove", ["variant", _]) => entries(file, false),
        _ => Vec::new(),
    }
}

/// Names of groups that the scene has.
fn light_groups(file: &Arc<Source>) -> Vec<String> {
    let mut found = BTreeSet::from([LightGroup::default().name().to_owned()]);
    for part in with_scopes(file) {
        let is_group = |part: &Part| matches!(part, Part::Value(key) if key == "light_group");
        let words = words(&part.source).into_iter();
        found.extend(words.filter(|w| is_group(&w.part)).map(|w| w.text));
    }
    found.retain(|name| LightGroup::new(name).is_some());
    found.into_iter().collect()
}

/// Entries of the scene, such as `light.lamp`; with `below` of its base and included files alone, whose entries a layer
/// may take out.
fn entries(file: &Arc<Source>, below: bool) -> Vec<String> {
    let mut found = BTreeSet::new();
    for part in with_scopes(file).iter().skip(usize::from(below)) {
        let own = names(&part.source).into_iter();
        let is_entry = |kind: &str| kind == "instance" || ENTRY_KINDS.contains(&kind);
        let entries = own.filter(|name| part.prefix.is_empty() && is_entry(&name.kind));
        found.extend(entries.map(|name| format!("{}.{}", name.kind, name.name)));
    }
    found.into_iter().collect()
}
