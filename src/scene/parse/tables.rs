//! Tables of scene text and of the text of projects as their readers declare them, and the table that applies at a
//! position.

use std::{ffi::OsStr, path::Path};

use super::{recorded_keys, recorded_project_keys};
use crate::desc::ProjectDesc;
use crate::syntax::Content;
use crate::table::{key_recorder::Form, key_recorder::KeyRecord, key_recorder::SectionRecord};
use crate::{diagnostic::Source, suggest::nearest};

/// Whether a file is a project, by its name.
pub fn is_project(path: &Path) -> bool {
    path.file_name() == Some(OsStr::new(ProjectDesc::FILE))
}

/// Whether a TOML file is text of scenes: its first line names Reflet's schema and no other, or, where it names none, the keys
/// and tables at its top are all a scene's, nearly or begun, or there are a table of scenes and a whole number as `version`.
pub fn is_scene_text(source: &Source) -> bool {
    let known = || keys_of(&recorded_keys()[0]).map(|(_, key)| key.name);
    let is_near =
        |name: &str| known().any(|key| key.starts_with(name)) || nearest(name, known()).is_some();
    let first = source.text.lines().next().unwrap_or_default();
    let root = source.syntax().root();
    let mut names = root.keys().map(|name| name.get_ref().as_str());
    let version = root.get("version").map(|version| version.get_ref());
    if first.contains("#:schema") {
        return first.contains("reflet");
    }
    matches!(version, Some(Content::Integer(_)))
        && names
            .clone()
            .any(|name| Below::scene().below(name).is_some())
        || names.all(is_near)
}

/// Whether a text is a scene of its own, by its version, or a camera where that was forgotten: others are for `include`.
pub fn is_scene(source: &Source) -> bool {
    let root = source.syntax().root();
    is_scene_text(source)
        && ["version", "camera"]
            .iter()
            .any(|key| root.contains_key(*key))
}

/// The manual of one kind of text.
#[derive(Clone, Copy, Debug)]
pub struct Manual(&'static [SectionRecord]);

/// Content below a path of keys.
#[derive(Clone, Copy, Debug)]
pub enum Below {
    /// Keys of a table.
    Table(&'static SectionRecord),
    /// Names chosen by the user, each with a table of these keys.
    Names(&'static SectionRecord),
}

impl Below {
    /// The whole of a scene.
    pub fn scene() -> Self {
        Self::Table(&recorded_keys()[0])
    }

    /// Key of a table.
    pub fn key(self, name: &str) -> Option<&'static KeyRecord> {
        match self {
            Self::Names(_) => None,
            Self::Table(section) => keys_of(section)
                .map(|(_, key)| key)
                .find(|k| k.name == name),
        }
    }

    /// Content below a key or name; `None` if the manual has none.
    pub fn below(self, key: &str) -> Option<Self> {
        match self {
            Self::Names(section) => Some(Self::Table(section)),
            Self::Table(_) => {
                let key = self.key(key)?;
                let all = recorded_keys().iter().chain(recorded_project_keys());
                let section_of = |name: &str| all.clone().find(|s| s.type_name == name);
                key.forms.iter().find_map(|form| match form {
                    Form::Table(name) | Form::List(name) => section_of(name).map(Self::Table),
                    Form::Entries(name) => section_of(name).map(Self::Names),
                    Form::Value(..) => None,
                })
            }
        }
    }
}

impl Manual {
    /// The manual of a file, by its name.
    pub fn for_file(path: &Path) -> Self {
        Self(match is_project(path) {
            true => recorded_project_keys(),
            false => recorded_keys(),
        })
    }

    /// Content below a path of keys from the top of the file; `None` if the manual has none.
    pub fn below(self, keys: &[String]) -> Option<Below> {
        let keys = match keys {
            // A variant contains the tables of a scene again.
            [first, _, rest @ ..] if first == "variant" => rest,
            keys => keys,
        };
        let whole = Below::Table(self.0.first()?);
        keys.iter().try_fold(whole, |place, key| place.below(key))
    }

    /// Table at a path of keys.
    pub fn table(self, keys: &[String]) -> Option<&'static SectionRecord> {
        match self.below(keys)? {
            Below::Table(section) => Some(section),
            Below::Names(_) => None,
        }
    }

    /// Key in the table at a path of keys, with the variant that has it.
    pub fn key(
        self,
        keys: &[String],
        name: &str,
    ) -> Option<(
        &'static SectionRecord,
        Option<&'static str>,
        &'static KeyRecord,
    )> {
        let section = self.table(keys)?;
        let (word, key) = keys_of(section).find(|(_, key)| key.name == name)?;
        Some((section, word, key))
    }
}

/// All keys of a table, each with the variant that has it.
pub fn keys_of(
    section: &'static SectionRecord,
) -> impl Iterator<Item = (Option<&'static str>, &'static KeyRecord)> {
    let own = section.keys.iter().map(|key| (None, key));
    let of_variants = section.variants.iter();
    own.chain(of_variants.flat_map(|v| v.keys.iter().map(|key| (Some(v.word), key))))
}
