//! Table of the manual that applies at a position in scene text or in the text of a project.

use std::{ffi::OsStr, path::Path, sync::LazyLock};

use crate::scene::{
    parse::{Form, KeyRecord, SectionRecord, recorded_keys, recorded_project_keys},
    project,
};

static SCENE: LazyLock<Vec<SectionRecord>> = LazyLock::new(|| recorded_keys().sections);
static PROJECT: LazyLock<Vec<SectionRecord>> = LazyLock::new(|| recorded_project_keys().sections);

/// Whether a file is that of a project, by its name.
pub fn is_project(path: &Path) -> bool {
    path.file_name() == Some(OsStr::new(project::FILE))
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

impl Manual {
    /// The manual of a file, by its name.
    pub fn of(path: &Path) -> Self {
        Self(if is_project(path) { &PROJECT } else { &SCENE })
    }

    /// Content below a path of keys from the top of the file; `None` if the manual has none.
    pub fn below(self, keys: &[String]) -> Option<Below> {
        let keys = match keys {
            // A variant contains the tables of a scene again.
            [first, _, rest @ ..] if first == "variant" => rest,
            keys => keys,
        };
        let mut place = Below::Table(self.0.first()?);
        for key in keys {
            place = match place {
                Below::Names(section) => Below::Table(section),
                Below::Table(section) => {
                    let forms = keys_of(section).find(|(_, k)| k.name == key)?.1;
                    forms.forms.iter().find_map(|form| match form {
                        Form::Table(name) | Form::List(name) => {
                            self.section_of(name).map(Below::Table)
                        }
                        Form::Entries(name) => self.section_of(name).map(Below::Names),
                        Form::Value(..) => None,
                    })?
                }
            };
        }
        Some(place)
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

    fn section_of(self, type_name: &str) -> Option<&'static SectionRecord> {
        self.0.iter().find(|s| s.type_name == type_name)
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
