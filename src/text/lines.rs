//! Places of letters in lines of text.

use harfrust::{Direction, Feature, ShapeOptions, ShaperData, Tag, UnicodeBuffer};

use super::{
    font::{Font, WrongFont},
    runs::{Run, runs},
};

/// Lines of text.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lines<'a> {
    /// The text, whose lines end at `\n`.
    pub text: &'a str,
    /// Size of the font, its em; other lengths have the same unit.
    pub size: f32,
    /// Distance from line to line, as a factor on `size`.
    pub line_height: f32,
    /// Space that is added between letters, each with its marks, as a factor on `size`.
    pub letter_spacing: f32,
    /// Place of x = 0 in each line: 0 is its left end, 1 its right end.
    pub align: f64,
}

/// A line of text.
#[derive(Clone, Debug)]
pub struct Line {
    /// Letters from left to right.
    pub letters: Vec<Letter>,
    /// Advance: distance from the begin of the first letter to the end of the last one, below 0 where a negative
    /// `letter_spacing` sets the last one before the first.
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
    /// All letters, from left to right and line after line.
    pub fn letters(&self, font: &Font) -> impl Iterator<Item = Letter> {
        self.set_in(font).into_iter().flat_map(|line| line.letters)
    }

    /// The letters that can be seen: spaces, and marks of direction or of joining, have no outlines.
    pub fn visible_letters(&self, font: &Font) -> impl Iterator<Item = Letter> {
        let is_visible = move |letter: &Letter| letter.glyphs.iter().any(|g| font.has_outline(g.0));
        self.letters(font).filter(is_visible)
    }

    /// A visible letter by its number, from 0.
    ///
    /// # Errors
    /// A text with fewer letters.
    pub fn letter(&self, font: &Font, number: u32) -> Result<Letter, WrongFont> {
        let letters: Vec<Letter> = self.visible_letters(font).collect();
        let last = match letters.len().checked_sub(1) {
            None => "the text has no letters".to_owned(),
            Some(last) => format!("the last letter has the number {last}"),
        };
        letters.into_iter().nth(number as usize).ok_or(WrongFont {
            message: format!("`letter` is {number}, and {last}"),
            help: "letters are counted from 0, without spaces, and letters that the font draws as one, such as \"fi\", count once",
        })
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
            let mut letters: Vec<Letter> = Vec::new();
            for Run { range, is_leftward } in runs(line) {
                let mut buffer = UnicodeBuffer::new();
                buffer.push_str(&line[range.clone()]);
                buffer.guess_segment_properties();
                buffer.set_direction(match is_leftward {
                    true => Direction::RightToLeft,
                    false => Direction::LeftToRight,
                });
                let run = shaper.shape(buffer, ShapeOptions::new().features(features));
                let infos = run.glyph_infos();
                let glyphs: Vec<_> = infos.iter().zip(run.glyph_positions()).collect();
                for cluster in glyphs.chunk_by(|a, b| a.0.cluster == b.0.cluster) {
                    let start = cluster[0].0.cluster;
                    let later = infos.iter().map(|info| info.cluster);
                    let next = later.filter(|next| *next > start).min();
                    let end = next.map_or(range.end, |next| range.start + next as usize);
                    let text = line.get(range.start + start as usize..end);
                    let mut letter = Letter {
                        text: text.unwrap_or_default().to_owned(),
                        place: [0.0; 2],
                        width: 0.0,
                        glyphs: Vec::new(),
                    };
                    for (info, place) in cluster {
                        let [dx, dy] =
                            [place.x_offset, place.y_offset].map(|o| f64::from(o) * unit);
                        letter.glyphs.push((info.glyph_id, [letter.width + dx, dy]));
                        letter.width += f64::from(place.x_advance) * unit;
                    }
                    letters.push(letter);
                }
            }
            // Marks of direction or of joining take no space (CSS Text 3, §8.2).
            let spaced = letters.iter().filter(|letter| letter.width != 0.0).count();
            let width = letters.iter().map(|letter| letter.width).sum::<f64>()
                + spacing * spaced.saturating_sub(1) as f64;
            let mut x = -width * self.align;
            let y = -(number as f64) * f64::from(self.line_height * self.size);
            for letter in &mut letters {
                for (_, place) in &mut letter.glyphs {
                    *place = [place[0] + x, place[1] + y];
                }
                letter.place = [x + self.align * letter.width, y];
                x += letter.width + if letter.width == 0.0 { 0.0 } else { spacing };
            }
            Line { letters, width }
        };
        self.text.lines().enumerate().map(set).collect()
    }
}
