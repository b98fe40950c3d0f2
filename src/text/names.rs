//! Names of the fonts in a file, read without the rest of it.

use std::io::{Cursor, Read, Seek, SeekFrom};

use skrifa::{
    FontRef,
    raw::{FontData, FontRead as _, tables::name::Name, types::NameId},
};

/// Beginning of a file that lists its fonts and their tables, bytes.
const LISTED: u64 = 1 << 16;
/// Longest table of names that is read, bytes.
const MOST_NAMES: u64 = 1 << 20;

/// Names of a font in a file, in all languages (OpenType 1.9.1, table `name`).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FontNames(Vec<(NameId, String)>);

impl FontNames {
    /// Names of all fonts of a file, in its order; a font without readable names has none.
    pub fn read(mut file: impl Read + Seek) -> Vec<Self> {
        let mut listed = Vec::new();
        let start = file.by_ref().take(LISTED).read_to_end(&mut listed);
        let fonts = FontRef::fonts(&listed).take_while(|_| start.is_ok());
        (fonts.map(|font| Self::of_font(&font.ok()?, &mut file)))
            .map(Option::unwrap_or_default)
            .collect()
    }

    fn of_font(font: &FontRef, file: &mut (impl Read + Seek)) -> Option<Self> {
        let mut tables = font.table_directory().table_records().iter();
        let table = tables.find(|table| table.tag() == "name")?;
        let most = MOST_NAMES.min(table.length().into());
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(table.offset().into())).ok()?;
        file.take(most).read_to_end(&mut bytes).ok()?;
        let table = Name::read(FontData::new(&bytes)).ok()?;
        let names = table.name_record().iter().filter_map(|record| {
            let name = record.string(table.string_data()).ok()?;
            Some((record.name_id(), name.chars().collect()))
        });
        Some(Self(names.collect()))
    }

    /// How well a name fits, less is better: 0 is the font's own full or PostScript name, 1 the name of its family where
    /// it is the plain font of it, 2 another font of the family; `None` where it does not fit.
    pub fn fit(&self, name: &str) -> Option<u8> {
        const PLAIN: [&str; 4] = ["regular", "book", "normal", "roman"];
        let name = name.to_lowercase();
        let has = |ids: &[NameId], is_right: &dyn Fn(&str) -> bool| {
            let mut own = self.0.iter().filter(|(id, _)| ids.contains(id));
            own.any(|(_, own)| is_right(&own.to_lowercase()))
        };
        let families = [NameId::FAMILY_NAME, NameId::TYPOGRAPHIC_FAMILY_NAME];
        let styles = [NameId::SUBFAMILY_NAME, NameId::TYPOGRAPHIC_SUBFAMILY_NAME];
        match () {
            () if has(&[NameId::FULL_NAME, NameId::POSTSCRIPT_NAME], &|own| {
                own == name
            }) =>
            {
                Some(0)
            }
            () if !has(&families, &|own| own == name) => None,
            () if has(&styles, &|own| PLAIN.contains(&own)) => Some(1),
            () => Some(2),
        }
    }

    /// Full names, such as "DejaVu Sans Bold".
    pub fn full(&self) -> impl Iterator<Item = &str> {
        let names = self.0.iter().filter(|(id, _)| *id == NameId::FULL_NAME);
        names.map(|(_, name)| name.as_str())
    }

    /// Number of the font in the bytes of a file that a name fits best; 0, the first, where it fits none.
    pub(crate) fn number(bytes: &[u8], name: &str) -> u32 {
        if !bytes.starts_with(b"ttcf") {
            return 0; // a single font
        }
        let fonts = (0..).zip(Self::read(Cursor::new(bytes)));
        let fits = fonts.filter_map(|(number, names)| Some((names.fit(name)?, number)));
        fits.min().map_or(0, |(_, number)| number)
    }
}
