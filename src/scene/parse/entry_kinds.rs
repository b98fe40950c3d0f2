//! Kinds of entries whose names users choose.

use crate::{suggest, syntax::Entries};

/// Tables of the scene whose entries have names, such as `[camera.main]`. Instances are a list, and have names where
/// their author gives them one.
pub const ENTRY_KINDS: [&str; 7] = [
    "camera", "decal", "group", "light", "material", "model", "probe",
];

/// Note that a name which refers to no entry of one kind is the name of an entry of another kind; else empty.
pub fn named_elsewhere(root: &Entries, name: &str) -> String {
    let has = |kind: &&&str| {
        let table = root.get(**kind).and_then(|node| node.get_ref().as_table());
        table.is_some_and(|table| table.contains_key(name))
    };
    ENTRY_KINDS
        .iter()
        .find(has)
        .map_or_else(String::new, |kind| {
            format!("{} is a {kind}; ", suggest::text(name))
        })
}
