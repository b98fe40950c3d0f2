//! Names of the fonts in a file, read without the rest of it.

use std::io::{Cursor, Read, Seek, SeekFrom};

use skrifa::{
    Tag,
    raw::{
        FontData, FontRead as _, TTCHeader, TableDirectory,
        tables::name::{Name, NameRecord},
        types::NameId,
    },
};

/// Most fonts of a file, longest list of tables of a font, longest table of names, and longest name, bytes.
const MOST_FONTS: u64 = 512;
const MOST_TABLES: u64 = 1 << 12;
const MOST_NAMES: u64 = 1 << 17;
const MOST_NAME: u16 = 512;

/// Families and styles: of any number of styles, then of four, which older systems list.
const FAMILIES: [[NameId; 2]; 2] = [
    [
        NameId::TYPOGRAPHIC_FAMILY_NAME,
        NameId::TYPOGRAPHIC_SUBFAMILY_NAME,
    ],
    [NameId::FAMILY_NAME, NameId::SUBFAMILY_NAME],
];
/// Names of a single font.
const OWN: [NameId; 2] = [NameId::FULL_NAME, NameId::POSTSCRIPT_NAME];

/// Names of a font in a file, in all languages, in Unicode or Mac Roman (OpenType 1.9.1, table `name`): its own, its families
/// and styles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FontNames(Vec<(NameId, String)>);

impl FontNames {
    /// Names of all fonts of a file, in its order; a font without readable names has none. Bytes that are read and decoded
    /// are taken from `left`; fonts for which less is left have no names.
    pub fn read(mut file: impl Read + Seek, left: &mut u64) -> Vec<Self> {
        let mut begin = Vec::new();
        let most = TTCHeader::MIN_SIZE as u64 + 4 * MOST_FONTS;
        let is_read = file.by_ref().take(most).read_to_end(&mut begin).is_ok();
        let places = match TTCHeader::read(FontData::new(&begin)) {
            Ok(header) if is_read && header.ttc_tag() == Tag::new(b"ttcf") => {
                let places = header.table_directory_offsets().iter();
                places.map(|place| place.get()).collect()
            }
            _ => vec![0],
        };
        let names = places
            .into_iter()
            .map(|place| Self::at(place, &mut file, left));
        names.map(Option::unwrap_or_default).collect()
    }

    /// Names of the font whose list of tables is at a place of a file.
    fn at(place: u32, file: &mut (impl Read + Seek), left: &mut u64) -> Option<Self> {
        let mut part = |place: u32, most: u64, left: &mut u64| {
            let mut bytes = Vec::new();
            file.seek(SeekFrom::Start(place.into())).ok()?;
            file.by_ref().take(most).read_to_end(&mut bytes).ok()?;
            *left = left.checked_sub(bytes.len() as u64)?;
            Some(bytes)
        };
        let tables = part(place, MOST_TABLES, left)?;
        let tables = TableDirectory::read(FontData::new(&tables)).ok()?;
        let table = (tables.table_records().iter()).find(|table| table.tag() == "name")?;
        let names = part(table.offset(), MOST_NAMES.min(table.length().into()), left)?;
        let names = Name::read(FontData::new(&names)).ok()?;
        let is_wanted = |record: &&NameRecord| {
            let mut ids = FAMILIES.as_flattened().iter().chain(&OWN);
            record.length() <= MOST_NAME && ids.any(|id| *id == record.name_id())
        };
        let mut kept = Vec::new();
        for record in names.name_record().iter().filter(is_wanted) {
            *left = left.checked_sub(record.length().into())?;
            if let Ok(name) = record.string(names.string_data()) {
                kept.push((record.name_id(), name.chars().collect()));
            }
        }
        Some(Self(kept))
    }

    /// How well a name fits, less is better: 0 is the font's own full or PostScript name, 1 the name of its family where
    /// it is the plain style of it, 2 another style of the family; `None` where it does not fit.
    pub fn fit(&self, name: &str) -> Option<u8> {
        const PLAIN: [&str; 4] = ["regular", "book", "normal", "roman"];
        let name = name.to_lowercase();
        let has = |ids: &[NameId], names: &[&str]| {
            let mut own = self.0.iter().filter(|(id, _)| ids.contains(id));
            own.any(|(_, own)| names.contains(&own.to_lowercase().as_str()))
        };
        if has(&OWN, &[&name]) {
            return Some(0);
        }
        let fitting = FAMILIES
            .iter()
            .filter(|[family, _]| has(&[*family], &[&name]));
        let fits = fitting.map(|[_, style]| if has(&[*style], &PLAIN) { 1 } else { 2 });
        fits.min()
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
        let fonts = (0..).zip(Self::read(Cursor::new(bytes), &mut (1 << 26)));
        let fits = fonts.filter_map(|(number, names)| Some((names.fit(name)?, number)));
        fits.min().map_or(0, |(_, number)| number)
    }
}
