//! Letters with a thickness.

use glam::DVec2;
use reflet_base::guard;
use reflet_scene::desc::{FileDesc, ShapeDesc};
use reflet_text::{Font, Lines, WrongFont};

use super::{
    Fault, Supplies, extrude,
    flatten::{MOST_CHORDS, Pen},
    region::Region,
    solid::Solid,
};

impl From<WrongFont> for Fault {
    fn from(wrong: WrongFont) -> Self {
        Self::new("wrong-font", wrong.message).help(wrong.help)
    }
}

/// Adds a text; returns a warning where its font lacks a character.
///
/// # Errors
/// `wrong-font` for bytes that are no font with outlines; `out-of-range` for a letter that the text lacks; the errors of
/// `extrude::add`.
pub fn add(
    solid: &mut Solid,
    shape: &ShapeDesc,
    supplies: &Supplies,
) -> Result<Option<Fault>, Fault> {
    let (
        Some(lines),
        ShapeDesc::Text {
            font,
            letter,
            letter_at,
            depth,
            bevel,
            segments,
            at,
            ..
        },
    ) = (shape.lines(), shape)
    else {
        return Ok(None);
    };
    let read = |font: &FileDesc| supplies.files.get(&font.file).map(Vec::as_slice);
    let bytes = font.as_ref().and_then(read).unwrap_or(Font::OWN);
    let name = font.as_ref().map_or("", |font| &font.file);
    let font_at = font.as_ref().map_or(at, |font| &font.at);
    let here = |fault: Fault| fault.placed(at.0.clone());
    let in_font = |fault: Fault| match fault.name {
        "wrong-font" => {
            let named = font.as_ref().map(|font| font.message(&fault.message));
            let message = named.unwrap_or(fault.message);
            Fault { message, ..fault }.placed(font_at.0.clone())
        }
        "out-of-range" => fault.placed(letter_at.0.clone()),
        _ => here(fault),
    };
    let mut pen = Pen::new(*segments);
    let drawn = guard::catch(|| draw(&mut pen, &lines, &Font::open(bytes, name)?, *letter))
        .unwrap_or_else(|| Err(WrongFont::damaged().into()));
    let missing = drawn.map_err(in_font)?;
    if pen.loops.is_empty() {
        let message = "the font has no outlines for this text";
        return Err(here(WrongFont::new(message).into()));
    }
    let region = Region::of_loops(pen.loops, supplies).map_err(here)?;
    extrude::add(solid, &region, *depth, bevel).map_err(here)?;
    Ok((!missing.is_empty()).then(|| {
        let message = format!("the font has no letters for {missing:?}; boxes stand for them");
        here(Fault::new("missing-letters", message).help("name a `font` that has them"))
    }))
}

/// Whether a font has a letter for each character of a text.
pub fn has_letters(bytes: &[u8], text: &str) -> bool {
    let lines = Lines {
        text,
        ..Lines::default()
    };
    let lacks = |font: &Font| lines.letters(font).any(|letter| letter.is_missing());
    guard::catch(|| Font::open(bytes, "").is_ok_and(|font| !lacks(&font))).unwrap_or(false)
}

/// Edges of the closed outlines of a line in the font of shapes, from its start on the base line, in pixels, upwards.
pub fn edges(text: &str, font_px: f32) -> Vec<[DVec2; 2]> {
    let mut pen = Pen::new(32);
    let lines = Lines {
        text,
        size: font_px,
        ..Lines::default()
    };
    let font = Font::open(Font::OWN, "").map_err(Fault::from);
    let drawn = font.and_then(|font| draw(&mut pen, &lines, &font, None));
    let drawn = drawn.and_then(|_| pen.finish());
    let chords = drawn.into_iter().flatten().flatten();
    chords.map(|chord| chord.ends).collect()
}

/// Draws all letters, or a single letter at the origin; returns the characters that the font lacks.
fn draw(pen: &mut Pen, lines: &Lines, font: &Font, only: Option<u32>) -> Result<String, Fault> {
    let past = |wrong: WrongFont| Fault::new("out-of-range", wrong.message).help(wrong.help);
    let only = only.map(|number| lines.letter(font, number)).transpose();
    let only = only.map_err(past)?;
    let origin = only.as_ref().map_or([0.0; 2], |letter| letter.place);
    let letters = only.map_or_else(|| lines.letters(font).collect(), |letter| vec![letter]);
    let mut missing = String::new();
    for letter in &letters {
        for (glyph, [x, y]) in &letter.glyphs {
            let place = [x - origin[0], y - origin[1]];
            let outline = font.outline(*glyph, lines.size, place)?;
            outline.into_iter().for_each(|part| pen.draw(part));
            if pen.count > MOST_CHORDS {
                let message = format!("the text has more than {MOST_CHORDS} chords");
                return Err(Fault::new("shape-too-large", message).help("lower `segments`"));
            }
        }
        if letter.is_missing() {
            let letter = letter.text.chars().next();
            missing.extend(letter.filter(|letter| !missing.contains(*letter)));
        }
    }
    pen.close();
    Ok(missing)
}
