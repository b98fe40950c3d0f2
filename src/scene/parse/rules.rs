//! Rules about keys that exclude each other, as the readers of their tables declare them.

use super::tables::Below;
use crate::table::{key_recorder::SectionRecord, key_recorder::VariantRecord};
use crate::{declared::Described, desc::SceneDesc, syntax::Entries};

/// Content below a key of the content at `place`; `None` where no reader declares any.
pub fn content_below(place: Option<Below>, key: &str) -> Option<Below> {
    match place? {
        // A variant contains the tables of a scene again.
        Below::Table(section) if section.type_name == SceneDesc::DOC.name && key == "variant" => {
            Some(Below::Names(section))
        }
        place => place.below(key),
    }
}

/// Rules about the keys of a table, as its reader declares them.
#[derive(Clone, Copy)]
pub struct Rules {
    section: &'static SectionRecord,
    kind: Option<&'static VariantRecord>,
}

impl Rules {
    /// Rules of the table at `place`, whose kind the first of `layers` says that has one; `None` where no reader
    /// declares any, and for names, which exclude nothing: a model may be called "file", and another one "shape".
    pub fn at_place(place: Option<Below>, layers: &[&Entries]) -> Option<Self> {
        let Below::Table(section) = place? else {
            return None;
        };
        let key = section.variants.first().map(|variant| variant.key);
        let word = key.and_then(|key| layers.iter().find_map(|layer| layer.get(key)));
        let word = word.and_then(|node| node.get_ref().as_str());
        let kind = section.variants.iter().find(|v| Some(v.word) == word);
        Some(Self { section, kind })
    }

    /// Keys that cannot stand beside this one, and keys that mean nothing without them: as few as there are, however
    /// many the table has.
    pub fn excluded_by(self, key: &str) -> impl Iterator<Item = &'static str> {
        let rules = self.kind.map_or(&[][..], |kind| &kind.rules);
        let rules = self.section.rules.iter().chain(rules);
        rules.flat_map(move |rule| {
            let own = rule.groups.iter().position(|group| group.contains(&key));
            let others = rule.groups.iter().enumerate();
            let others = others.filter(move |(i, _)| own.is_some_and(|own| own != *i));
            others.flat_map(move |(_, group)| group.iter().flat_map(move |key| self.with(key)))
        })
    }

    /// A key, and the keys that mean nothing without it.
    fn with(self, key: &'static str) -> impl Iterator<Item = &'static str> {
        let needing = self.kind.map_or(&[][..], |kind| &kind.needing);
        let needing = self.section.needing.iter().chain(needing);
        let needing = needing.filter(move |needing| needing.key == key);
        std::iter::once(key).chain(needing.flat_map(|needing| needing.others.iter().copied()))
    }

    /// Removes the keys that cannot stand beside this one.
    pub fn make_room(self, table: &mut Entries, key: &str) {
        for other in self.excluded_by(key) {
            table.remove(other);
        }
    }
}
