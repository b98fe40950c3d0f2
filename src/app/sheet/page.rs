//! Page of a contact sheet: pictures in rows, each with a label below.

use font8x8::UnicodeFonts as _;

/// Distance between pictures, and around labels, pixels.
const GAP_PX: u32 = 8;
/// Size of a character, pixels.
const FONT_PX: u32 = 8;
/// Largest width and height of a sheet, pixels.
pub const MOST_PX: u32 = 16384;
/// Gray of the page and white of the labels, sRGB.
const PAGE: [u8; 4] = [32, 32, 32, 255];
const INK: [u8; 4] = [235, 235, 235, 255];

/// A page with places for pictures of one size.
pub struct Page {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Display color, RGBA, sRGB.
    pub pixels: Vec<u8>,
    cell: [u32; 2],
    columns: u32,
    /// Pixels of the page for each of the font.
    scale: u32,
}

impl Page {
    /// An empty page for `count` pictures of `cell` pixels; `None` if it is larger than [`MOST_PX`].
    pub fn new(cell: [u32; 2], count: u32, columns: u32) -> Option<Self> {
        let scale = (cell[0] / 400).clamp(1, 4);
        let columns = columns.clamp(1, count.max(1));
        let side = |cell: u32, count: u32| {
            let whole = u64::from(cell + GAP_PX) * u64::from(count) + u64::from(GAP_PX);
            u32::try_from(whole).ok().filter(|side| *side <= MOST_PX)
        };
        let label = FONT_PX * scale + GAP_PX;
        let size = [
            side(cell[0], columns)?,
            side(cell[1] + label, count.max(1).div_ceil(columns))?,
        ];
        Some(Self {
            size,
            pixels: PAGE.repeat((size[0] * size[1]) as usize),
            cell,
            columns,
            scale,
        })
    }

    /// Puts a picture in its place, with its label.
    pub fn put(&mut self, index: u32, rgba: &[u8], label: &str) {
        let label_px = FONT_PX * self.scale + GAP_PX;
        let x = GAP_PX + (index % self.columns) * (self.cell[0] + GAP_PX);
        let y = GAP_PX + (index / self.columns) * (self.cell[1] + label_px + GAP_PX);
        let row_bytes = self.cell[0] as usize * 4;
        for (row, line) in rgba.chunks_exact(row_bytes).enumerate() {
            let start = self.offset(x, y + row as u32);
            self.pixels[start..start + row_bytes].copy_from_slice(line);
        }
        let top = y + self.cell[1] + GAP_PX / 2;
        self.write([x, top], label);
    }

    fn offset(&self, x: u32, y: u32) -> usize {
        (y * self.size[0] + x) as usize * 4
    }

    /// Writes a text, cut off at the width of a picture.
    fn write(&mut self, [x, y]: [u32; 2], text: &str) {
        let width = FONT_PX * self.scale;
        let fit = self.cell[0] / width;
        for (column, c) in (0..fit).zip(text.chars()) {
            let unknown = || font8x8::BASIC_FONTS.get('?');
            let glyph = font8x8::BASIC_FONTS
                .get(c)
                .or_else(|| font8x8::LATIN_FONTS.get(c));
            let glyph = glyph.or_else(unknown).unwrap_or_default();
            for (row, bits) in glyph.iter().enumerate() {
                for bit in (0..FONT_PX).filter(|bit| bits >> bit & 1 == 1) {
                    let at = [
                        x + column * width + bit * self.scale,
                        y + row as u32 * self.scale,
                    ];
                    self.dot(at);
                }
            }
        }
    }

    fn dot(&mut self, [x, y]: [u32; 2]) {
        for (dx, dy) in (0..self.scale).flat_map(|dx| (0..self.scale).map(move |dy| (dx, dy))) {
            let start = self.offset(x + dx, y + dy);
            self.pixels[start..start + 4].copy_from_slice(&INK);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_rows_with_their_labels() {
        let cell = [24, 10];
        let mut page = Page::new(cell, 3, 2).expect("small");
        assert_eq!(page.size, [8 + 2 * 32, 8 + 2 * 34]);
        let red = [255, 0, 0, 255].repeat(240);
        page.put(2, &red, "I and more");
        let at = |x: u32, y: u32| {
            let start = page.offset(x, y);
            [0, 1, 2].map(|i| page.pixels[start + i])
        };
        let first_of_row = 8 + 34;
        assert_eq!(
            [at(8, first_of_row), at(31, first_of_row + 9)],
            [[255, 0, 0]; 2]
        );
        assert_eq!(at(32, first_of_row), [32; 3]);
        // The label is below, and no wider than the picture.
        let inked = (0..page.size[0] * page.size[1])
            .map(|i| (i % page.size[0], i / page.size[0]))
            .filter(|(x, y)| at(*x, *y) == [235; 3]);
        let inked: Vec<_> = inked.collect();
        let below = first_of_row + 10..first_of_row + 24;
        assert!(!inked.is_empty());
        assert!(
            inked
                .iter()
                .all(|(x, y)| (8..32).contains(x) && below.contains(y))
        );
    }

    #[test]
    fn sheets_that_are_too_large_are_refused() {
        assert!(Page::new([8000, 100], 2, 2).is_some());
        assert!(Page::new([8200, 100], 2, 2).is_none());
        assert!(Page::new([100, 100], 1_000_000, 1).is_none());
        assert!(Page::new([u32::MAX - 20, 1], 1, 1).is_none());
    }
}
