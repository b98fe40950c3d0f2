//! Letters with a thickness.

use epaint_default_fonts::UBUNTU_LIGHT;
use glam::DVec2;
use harfrust::{Direction, Feature, ShapeOptions, ShaperData, Tag, UnicodeBuffer};
use kurbo::{PathEl, Point};
use reflet_base::guard;
use reflet_scene::desc::{ShapeDesc, TextAlign};
use skrifa::{
    FontRef, GlyphId, MetadataProvider as _,
    instance::{LocationRef, Size},
    outline::{DrawSettings, OutlineGlyphCollection, OutlinePen},
    raw::{
        TableProvider as _,
        tables::{
            glyf::{Glyf, Glyph},
            loca::Loca,
        },
    },
};

use super::{
    Fault, Supplies, charstring, extrude,
    flatten::{MOST_CHORDS, Pen},
    region::Region,
    runs::runs,
    solid::Solid,
};

/// Most parts of a glyph that is put together of others; letters with marks have a few.
const MOST_PARTS: usize = 1000;

/// Draws the outlines of glyphs, scaled and moved.
struct GlyphPen {
    pen: Pen,
    /// Place of the glyph's origin, meters.
    origin: [f64; 2],
    /// Meters per unit of the font.
    scale: f64,
}

impl GlyphPen {
    fn new(face: &FontRef, lines: &Lines, segments: u32) -> Self {
        let units = face.head().map_or(1, |head| head.units_per_em());
        Self {
            pen: Pen::new(segments),
            origin: [0.0; 2],
            scale: f64::from(lines.size) / f64::from(units.max(1)),
        }
    }

    fn point(&self, x: f32, y: f32) -> Point {
        let [left, bottom] = self.origin;
        let [x, y] = [x, y].map(|along| self.scale * f64::from(along));
        Point::new(left + x, bottom + y)
    }
}

impl OutlinePen for GlyphPen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.pen.draw(PathEl::MoveTo(self.point(x, y)));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.pen.draw(PathEl::LineTo(self.point(x, y)));
    }

    fn quad_to(&mut self, cx0: f32, cy0: f32, x: f32, y: f32) {
        let curve = PathEl::QuadTo(self.point(cx0, cy0), self.point(x, y));
        self.pen.draw(curve);
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        let [a, b, end] = [(cx0, cy0), (cx1, cy1), (x, y)].map(|(x, y)| self.point(x, y));
        self.pen.draw(PathEl::CurveTo(a, b, end));
    }

    fn close(&mut self) {
        self.pen.draw(PathEl::ClosePath);
    }
}

/// Adds a text; returns a warning where its font lacks a character.
///
/// # Errors
/// `wrong-font` for bytes that are no font with outlines; the errors of [`extrude::add`].
pub fn add(
    solid: &mut Solid,
    shape: &ShapeDesc,
    supplies: &Supplies,
) -> Result<Option<Fault>, Fault> {
    let ShapeDesc::Text {
        text,
        font,
        size,
        align,
        line_height,
        letter_spacing,
        depth,
        bevel,
        segments,
        at,
    } = shape
    else {
        return Ok(None);
    };
    let own = || (UBUNTU_LIGHT, at);
    let read = |file: &String| supplies.files.get(file).map(Vec::as_slice);
    let (bytes, font_at) = (font.as_ref())
        .and_then(|font| Some((read(&font.file)?, &font.at)))
        .unwrap_or_else(own);
    let in_font = |fault: Fault| fault.placed(font_at.0.clone());
    let face = open(bytes).map_err(in_font)?;
    let lines = Lines {
        text,
        size: *size,
        align: *align,
        line_height: *line_height,
        letter_spacing: *letter_spacing,
    };
    let mut pen = GlyphPen::new(&face, &lines, *segments);
    let drawn = guard::catch(|| draw_lines(&mut pen, &lines, &face)).unwrap_or_else(|| {
        let message = "this font is damaged, so that its letters cannot be read";
        Err(Fault::new("wrong-font", message).help("use another `font`"))
    });
    let missing = drawn.map_err(in_font)?;
    pen.pen.close();
    let here = |fault: Fault| fault.placed(at.0.clone());
    if pen.pen.loops.is_empty() {
        let message = "the font has no outlines for this text";
        return Err(here(
            Fault::new("wrong-font", message).help("use another `font`"),
        ));
    }
    let region = Region::of_loops(pen.pen.loops, supplies).map_err(here)?;
    extrude::add(solid, &region, *depth, bevel).map_err(here)?;
    Ok((!missing.is_empty()).then(|| {
        let message = format!("the font has no letters for {missing:?}; boxes stand for them");
        here(Fault::new("missing-letters", message).help("name a `font` that has them"))
    }))
}

/// Whether a font has a letter for each character of a text.
pub fn has_letters(bytes: &[u8], text: &str) -> bool {
    let has_all = || {
        let face = open(bytes).ok()?;
        let letters = face.charmap();
        let mut visible = text.chars().filter(|letter| !letter.is_whitespace());
        Some(visible.all(|letter| letters.map(letter).is_some_and(|glyph| glyph.to_u32() > 0)))
    };
    guard::catch(has_all).flatten().unwrap_or(false)
}

/// Opens a font with outlines.
fn open(bytes: &[u8]) -> Result<FontRef<'_>, Fault> {
    let wrong = |what: &str, help: &str| Fault::new("wrong-font", what).help(help);
    if bytes.starts_with(b"wOFF") || bytes.starts_with(b"wOF2") {
        let help = "unpack it to `.ttf` or `.otf`, for example with `fonttools`";
        return Err(wrong(
            "this is a web font (WOFF), which is compressed",
            help,
        ));
    }
    let help = "name a TrueType or OpenType font (`.ttf`, `.otf`)";
    let face = FontRef::from_index(bytes, 0)
        .map_err(|error| wrong(&format!("this is no font that can be read: {error}"), help))?;
    let units = face.head().map_or(0, |head| head.units_per_em());
    if units == 0 || face.outline_glyphs().format().is_none() {
        return Err(wrong("this font has no outlines", help));
    }
    Ok(face)
}

/// Edges of the closed outlines of a line in the font of shapes, from its start on the base line, in pixels, upwards.
pub fn edges(text: &str, font_px: f32) -> Vec<[DVec2; 2]> {
    let lines = Lines {
        text,
        size: font_px,
        align: TextAlign::Left,
        line_height: 1.0,
        letter_spacing: 0.0,
    };
    let drawn = open(UBUNTU_LIGHT).and_then(|face| {
        let mut pen = GlyphPen::new(&face, &lines, 32);
        draw_lines(&mut pen, &lines, &face)?;
        pen.pen.finish()
    });
    let chords = drawn.into_iter().flatten().flatten();
    chords.map(|chord| chord.ends).collect()
}

/// Lines of text.
struct Lines<'a> {
    text: &'a str,
    /// Height of a line's letters, of the unit of the outlines.
    size: f32,
    align: TextAlign,
    /// Distance of lines, and between letters more than the font's, of `size`.
    line_height: f32,
    letter_spacing: f32,
}

/// Draws all lines; returns the characters that the font lacks.
fn draw_lines(pen: &mut GlyphPen, lines: &Lines, face: &FontRef) -> Result<String, Fault> {
    let Lines {
        text,
        size,
        align,
        line_height,
        letter_spacing,
    } = lines;
    let data = ShaperData::new(face);
    let shaper = data.shaper(face).build();
    let glyphs = Glyphs {
        face,
        outlines: face.outline_glyphs(),
        tables: face.loca(None).ok().zip(face.glyf().ok()),
    };
    let spacing = f64::from(letter_spacing * size);
    // Letters that are spaced stand alone (CSS Text 3, §8.2).
    let apart = [b"liga", b"clig"].map(|tag| Feature::new(Tag::new(tag), 0, ..));
    let features = if spacing == 0.0 { &[][..] } else { &apart };
    let mut missing = String::new();
    for (number, line) in text.lines().enumerate() {
        let shaped: Vec<_> = (runs(line).into_iter())
            .map(|run| {
                let mut buffer = UnicodeBuffer::new();
                buffer.push_str(&line[run.range.clone()]);
                buffer.guess_segment_properties();
                buffer.set_direction(match run.is_leftward {
                    true => Direction::RightToLeft,
                    false => Direction::LeftToRight,
                });
                let shaped = shaper.shape(buffer, ShapeOptions::new().features(features));
                (run.range, shaped)
            })
            .collect();
        let advance =
            |place: &harfrust::GlyphPosition| f64::from(place.x_advance) * pen.scale + spacing;
        let places = shaped.iter().flat_map(|(_, run)| run.glyph_positions());
        let width: f64 = places.map(advance).sum::<f64>() - spacing;
        let mut x = match align {
            TextAlign::Left => 0.0,
            TextAlign::Center => -width / 2.0,
            TextAlign::Right => -width,
        };
        let y = -(number as f64) * f64::from(line_height * size);
        for (range, run) in &shaped {
            for (info, place) in run.glyph_infos().iter().zip(run.glyph_positions()) {
                let offset = [place.x_offset, place.y_offset].map(|o| f64::from(o) * pen.scale);
                let next = x + f64::from(place.x_advance) * pen.scale + spacing;
                pen.origin = [x + offset[0], y + offset[1]];
                draw_glyph(pen, &glyphs, info.glyph_id)?;
                let letter = (line.get(range.start + info.cluster as usize..))
                    .and_then(|rest| rest.chars().next());
                if info.glyph_id == 0 {
                    missing.extend(letter.filter(|letter| !missing.contains(*letter)));
                }
                x = next;
            }
        }
    }
    Ok(missing)
}

/// Outlines of a font, and its tables in which glyphs are put together of others.
struct Glyphs<'a> {
    face: &'a FontRef<'a>,
    outlines: OutlineGlyphCollection<'a>,
    tables: Option<(Loca<'a>, Glyf<'a>)>,
}

impl Glyphs<'_> {
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

fn draw_glyph(pen: &mut GlyphPen, glyphs: &Glyphs, glyph: u32) -> Result<(), Fault> {
    let mut parts = 0;
    glyphs.count_parts(GlyphId::new(glyph), &mut parts);
    if parts > MOST_PARTS {
        let message =
            format!("a letter of this font is put together of more than {MOST_PARTS} others");
        return Err(Fault::new("wrong-font", message).help("use another `font`"));
    }
    if !charstring::ends(glyphs.face, GlyphId::new(glyph)) {
        let message = "the subroutines of a letter of this font call each other too often";
        return Err(Fault::new("wrong-font", message).help("use another `font`"));
    }
    if let Some(glyph) = glyphs.outlines.get(GlyphId::new(glyph)) {
        let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        glyph.draw(settings, pen).map_err(|error| {
            let message = format!("a letter of this font cannot be read: {error}");
            Fault::new("wrong-font", message).help("use another `font`")
        })?;
    }
    if pen.pen.count > MOST_CHORDS {
        let message = format!("the text has more than {MOST_CHORDS} chords");
        return Err(Fault::new("shape-too-large", message).help("lower `segments`"));
    }
    Ok(())
}
