//! Fonts with outlines.

use epaint_default_fonts::UBUNTU_LIGHT;
use kurbo::{PathEl, Point};
use skrifa::{
    FontRef, GlyphId, MetadataProvider as _,
    instance::{LocationRef, Size},
    outline::{DrawSettings, OutlineGlyphCollection, pen::PathElement},
    raw::{
        TableProvider as _,
        tables::{
            glyf::{Glyf, Glyph},
            loca::Loca,
        },
    },
};

use super::{charstring, names::FontNames};

/// Most parts of a glyph that is put together of others; letters with marks have a few.
const MOST_PARTS: usize = 1000;

/// Reason why a font, or a letter of it, cannot be used.
#[derive(Clone, Debug)]
pub struct WrongFont {
    /// Message.
    pub message: String,
    /// Advice.
    pub help: &'static str,
}

impl WrongFont {
    /// A fault inside of a font.
    pub fn new(message: impl Into<String>) -> Self {
        let (message, help) = (message.into(), "use another `font`");
        Self { message, help }
    }

    /// The fault of a font with which a reader panics.
    pub fn damaged() -> Self {
        Self::new("this font is damaged, so that its letters cannot be read")
    }
}

/// A font with outlines.
pub struct Font<'a> {
    pub(crate) face: FontRef<'a>,
    outlines: OutlineGlyphCollection<'a>,
    /// Tables in which glyphs are put together of others.
    tables: Option<(Loca<'a>, Glyf<'a>)>,
    units_per_em: f64,
}

impl Font<'_> {
    /// Bytes of the font inside the program, Ubuntu Light.
    pub const OWN: &'static [u8] = UBUNTU_LIGHT;
}

impl<'a> Font<'a> {
    /// Opens the font of this name in the bytes of a font file, else the first of the file.
    ///
    /// # Errors
    /// Bytes that are no font with outlines.
    pub fn open(bytes: &'a [u8], name: &str) -> Result<Self, WrongFont> {
        if bytes.starts_with(b"wOFF") || bytes.starts_with(b"wOF2") {
            return Err(WrongFont {
                message: "this is a web font (WOFF), which is compressed".to_owned(),
                help: "unpack it to `.ttf` or `.otf`, for example with `fonttools`",
            });
        }
        let wrong = |message: String| WrongFont {
            message,
            help: "name a TrueType or OpenType font (`.ttf`, `.otf`)",
        };
        let face = FontRef::from_index(bytes, FontNames::number(bytes, name))
            .map_err(|error| wrong(format!("this is no font that can be read: {error}")))?;
        let units = face.head().map_or(0, |head| head.units_per_em());
        let outlines = face.outline_glyphs();
        if units == 0 || outlines.format().is_none() {
            return Err(wrong("this font has no outlines".to_owned()));
        }
        Ok(Self {
            tables: face.loca(None).ok().zip(face.glyf().ok()),
            units_per_em: units.into(),
            outlines,
            face,
        })
    }

    /// Length of a unit of the font whose em has a size.
    pub(crate) fn unit(&self, size: f32) -> f64 {
        f64::from(size) / self.units_per_em
    }

    /// Whether a glyph has an outline; one that is damaged has.
    pub(crate) fn has_outline(&self, glyph: u32) -> bool {
        self.outline(glyph, 1.0, [0.0; 2])
            .map_or(true, |outline| !outline.is_empty())
    }

    /// Outline of a glyph with its origin at a point, in a font of this size; y is up.
    ///
    /// # Errors
    /// A glyph that is damaged, or of too many parts or subroutines.
    pub fn outline(
        &self,
        glyph: u32,
        size: f32,
        [left, bottom]: [f64; 2],
    ) -> Result<Vec<PathEl>, WrongFont> {
        let (glyph, mut parts) = (GlyphId::new(glyph), 0);
        self.count_parts(glyph, &mut parts);
        if parts > MOST_PARTS {
            let message =
                format!("a letter of this font is put together of more than {MOST_PARTS} others");
            return Err(WrongFont::new(message));
        }
        if !charstring::ends(&self.face, glyph) {
            let message = "the subroutines of a letter of this font call each other too often";
            return Err(WrongFont::new(message));
        }
        let mut outline: Vec<PathElement> = Vec::new();
        if let Some(glyph) = self.outlines.get(glyph) {
            let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
            glyph.draw(settings, &mut outline).map_err(|error| {
                WrongFont::new(format!("a letter of this font cannot be read: {error}"))
            })?;
        }
        let unit = self.unit(size);
        let at = |x, y| Point::new(left + unit * f64::from(x), bottom + unit * f64::from(y));
        let part = |part| match part {
            PathElement::MoveTo { x, y } => PathEl::MoveTo(at(x, y)),
            PathElement::LineTo { x, y } => PathEl::LineTo(at(x, y)),
            PathElement::QuadTo { cx0, cy0, x, y } => PathEl::QuadTo(at(cx0, cy0), at(x, y)),
            PathElement::CurveTo {
                cx0,
                cy0,
                cx1,
                cy1,
                x,
                y,
            } => PathEl::CurveTo(at(cx0, cy0), at(cx1, cy1), at(x, y)),
            PathElement::Close => PathEl::ClosePath,
        };
        Ok(outline.into_iter().map(part).collect())
    }

    /// Counts a glyph and its components, as often as it has each, until there are too many.
    fn count_parts(&self, glyph: GlyphId, count: &mut usize) {
        *count += 1;
        let Some((loca, glyf)) = self.tables.as_ref().filter(|_| *count <= MOST_PARTS) else {
            return;
        };
        if let Ok(Some(Glyph::Composite(parts))) = loca.get_glyf(glyph, glyf) {
            parts
                .components()
                .for_each(|part| self.count_parts(part.glyph.into(), count));
        }
    }
}
