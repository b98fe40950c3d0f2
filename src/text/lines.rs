//! Places of letters in lines of text.

use harfrust::{Direction, Feature, ShapeOptions, ShaperData, Tag, UnicodeBuffer};

use super::{font::Font, runs::runs};

/// Lines of text.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a> {
    /// The text, whose lines end at `\n`.
    pub text: &'a str,
    /// Size of the font, its em; other lengths have the same unit.
    pub size: f32,
    /// Distance from line to line, as a factor on `size`.
    pub line_height: f32,
    /// Space that is added between letters, as a factor on `size`.
    pub letter_spacing: f32,
    /// Place of x = 0 in each line: 0 is its left end, 1 its right end.
    pub align: f64,
}

/// A line of text.
#[derive(Clone, Debug)]
pub struct Line {
    /// Letters from left to right.
    pub letters: Vec<Letter>,
    /// Distance from the begin of the first letter to the end of the last one.
    pub width: f64,
}

/// A letter, or several that the font draws as one.
#[derive(Clone, Debug)]
pub struct Letter {
    /// Characters that it stands for.
    pub text: String,
    /// Place on the base line at which it is aligned.
    pub place: [f64; 2],
    /// Distance from its begin to its end.
    pub width: f64,
    /// Glyphs, each with the place of its origin.
    pub glyphs: Vec<(u32, [f64; 2])>,
}

impl Letter {
    /// Whether it lacks a glyph, in whose place the font has a box.
    pub fn is_missing(&self) -> bool {
        self.glyphs.iter().any(|(glyph, _)| *glyph == 0)
    }
}

impl Lines<'_> {
    /// The letters that can be seen, from left to right and line after line: spaces, and marks of direction or of
    /// joining, have no outlines.
    pub fn visible_letters(&self, font: &Font) -> impl Iterator<Item = Letter> {
        let letters = self.set_in(font).into_iter().flat_map(|line| line.letters);
        letters.filter(|letter| letter.glyphs.iter().any(|glyph| font.has_outline(glyph.0)))
    }

    /// The lines in a font, the first on y = 0 and the others below.
    pub fn set_in(&self, font: &Font) -> Vec<Line> {
        let data = ShaperData::new(&font.face);
        let shaper = data.shaper(&font.face).build();
        let unit = font.unit(self.size);
        let spacing = f64::from(self.letter_spacing * self.size);
        // Letters that are spaced stand alone (CSS Text 3, §8.2).
        let apart = [b"liga", b"clig"].map(|tag| Feature::new(Tag::new(tag), 0, ..));
        let features = if spacing == 0.0 { &[][..] } else { &apart };
        let set = |(number, line): (usize, &str)| {
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
                |place: &harfrust::GlyphPosition| f64::from(place.x_advance) * unit + spacing;
            let places = shaped.iter().flat_map(|(_, run)| run.glyph_positions());
            let width: f64 = places.map(advance).sum::<f64>() - spacing;
            let mut x = -width * self.align;
            let y = -(number as f64) * f64::from(self.line_height * self.size);
            let mut letters: Vec<Letter> = Vec::new();
            for (range, run) in &shaped {
                let starts: Vec<_> = run
                    .glyph_infos()
                    .iter()
                    .map(|i| i.cluster as usize)
                    .collect();
                for (i, place) in run.glyph_positions().iter().enumerate() {
                    let [dx, dy] = [place.x_offset, place.y_offset].map(|o| f64::from(o) * unit);
                    let glyph = (run.glyph_infos()[i].glyph_id, [x + dx, y + dy]);
                    if i > 0
                        && starts[i] == starts[i - 1]
                        && let Some(letter) = letters.last_mut()
                    {
                        letter.glyphs.push(glyph);
                        letter.width += advance(place);
                    } else {
                        let next = starts.iter().filter(|start| **start > starts[i]).min();
                        let end = next.map_or(range.end, |next| range.start + next);
                        let text = line.get(range.start + starts[i]..end).unwrap_or_default();
                        letters.push(Letter {
                            text: text.to_owned(),
                            place: [x, y],
                            width: advance(place) - spacing,
                            glyphs: vec![glyph],
                        });
                    }
                    x += advance(place);
                }
            }
            for letter in &mut letters {
                letter.place[0] += self.align * letter.width;
            }
            Line { letters, width }
        };
        self.text.lines().enumerate().map(set).collect()
    }
}
