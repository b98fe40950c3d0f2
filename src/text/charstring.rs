//! Work of drawing a glyph of a PostScript font, counted before the library draws it: subroutines that call each other
//! ten deep, as deep as the library goes, would not end.

use std::cell::Cell;

use skrifa::{
    FontRef, GlyphId,
    raw::{
        TableProvider as _,
        ps::{
            cff::{CffFontRef, blend::BlendState, index::Index},
            cs::{CharstringContext, CharstringKind, CommandSink, evaluate},
            error::Error,
        },
        types::Fixed,
    },
};

/// Most bytes of subroutines that a glyph executes; letters of real fonts execute a few thousand.
const MOST_BYTES: usize = 1 << 20;

/// Subroutines of a font, and bytes of them that may still be executed.
struct Counted<'a> {
    font: (&'a [u8], &'a Index<'a>, &'a Index<'a>, &'a Index<'a>),
    left: Cell<Option<usize>>,
}

impl Counted<'_> {
    fn count<'b>(&self, subroutine: &'b [u8]) -> Result<&'b [u8], Error> {
        let left = self
            .left
            .get()
            .and_then(|left| left.checked_sub(1 + subroutine.len()));
        self.left.set(left);
        (left.map(|_| subroutine)).ok_or(Error::CharstringNestingDepthLimitExceeded)
    }
}

impl CharstringContext for Counted<'_> {
    fn kind(&self) -> CharstringKind {
        self.font.kind()
    }

    fn seac_components(&self, base: i32, accent: i32) -> Result<[&[u8]; 2], Error> {
        self.font.seac_components(base, accent)
    }

    fn global_subr(&self, index: i32) -> Result<&[u8], Error> {
        self.count(self.font.global_subr(index)?)
    }

    fn subr(&self, index: i32) -> Result<&[u8], Error> {
        self.count(self.font.subr(index)?)
    }
}

/// Takes the outline and draws nothing.
struct Nowhere;

impl CommandSink for Nowhere {
    fn move_to(&mut self, _: Fixed, _: Fixed) {}
    fn line_to(&mut self, _: Fixed, _: Fixed) {}
    fn curve_to(&mut self, _: Fixed, _: Fixed, _: Fixed, _: Fixed, _: Fixed, _: Fixed) {}
    fn close(&mut self) {}
}

/// Whether a glyph executes few enough subroutines. Fonts without PostScript outlines, and damaged ones, do: the library
/// says what is wrong with them.
pub fn ends(face: &FontRef<'_>, glyph: GlyphId) -> bool {
    let table = face.cff().map(|cff| cff.offset_data());
    let Ok(data) = table.or_else(|_| face.cff2().map(|cff| cff.offset_data())) else {
        return true;
    };
    let run = || {
        let font = CffFontRef::new(data.as_bytes(), 0, None).ok()?;
        let part = font.subfont(font.subfont_index(glyph)?, &[]).ok()?;
        let local = match part.subrs_offset() {
            0 => Index::Empty,
            offset => Index::new(font.data().get(offset as usize..)?, font.version() == 2).ok()?,
        };
        let store = font.var_store().cloned();
        let blend = store.and_then(|store| BlendState::new(store, &[], part.vs_index()).ok());
        let counted = Counted {
            font: (font.data(), font.charstrings(), font.global_subrs(), &local),
            left: Cell::new(Some(MOST_BYTES)),
        };
        let outline = font.charstrings().get(glyph.to_u32() as usize).ok()?;
        // Errors of the outline are told when it is drawn.
        let _ = evaluate(&counted, blend, outline, &mut Nowhere);
        Some(counted.left.get().is_some())
    };
    run().unwrap_or(true)
}
