//! Page of a contact sheet: pictures in rows, each with a label below.

use ab_glyph_rasterizer::{Rasterizer, point};

use crate::world::shape::text;

/// Distance between pictures, and around labels, pixels.
const GAP_PX: u32 = 8;
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
    /// Size of the font of labels, pixels.
    font_px: u32,
}

impl Page {
    /// An empty page for `count` pictures of `cell` pixels; `None` if it is larger than [`MOST_PX`].
    pub fn new(cell: [u32; 2], count: u32, columns: u32) -> Option<Self> {
        let font_px = (cell[0] / 24).clamp(12, 32);
        let columns = columns.clamp(1, count.max(1));
        let side = |cell: u32, count: u32| {
            let whole = u64::from(cell + GAP_PX) * u64::from(count) + u64::from(GAP_PX);
            u32::try_from(whole).ok().filter(|side| *side <= MOST_PX)
        };
        let label = label_px(font_px);
        let size = [
            side(cell[0], columns)?,
            side(cell[1] + label, count.max(1).div_ceil(columns))?,
        ];
        Some(Self {
            size,
            pixels: PAGE.repeat((size[0] * size[1]) as usize),
            cell,
            columns,
            font_px,
        })
    }

    /// Puts a picture in its place, with its label.
    pub fn put(&mut self, index: u32, rgba: &[u8], label: &str) {
        let x = GAP_PX + (index % self.columns) * (self.cell[0] + GAP_PX);
        let y = GAP_PX + (index / self.columns) * (self.cell[1] + label_px(self.font_px) + GAP_PX);
        let row_bytes = self.cell[0] as usize * 4;
        for (row, line) in rgba.chunks_exact(row_bytes).enumerate() {
            let start = self.offset(x, y + row as u32);
            self.pixels[start..start + row_bytes].copy_from_slice(line);
        }
        self.write([x, y + self.cell[1] + GAP_PX / 2], label);
    }

    fn offset(&self, x: u32, y: u32) -> usize {
        (y * self.size[0] + x) as usize * 4
    }

    /// Writes a text, cut off at the width of a picture.
    fn write(&mut self, [x, y]: [u32; 2], text: &str) {
        let most = self.cell[0] as usize;
        let text: String = text.chars().take(most).collect();
        let edges = text::edges(&text, self.font_px as f32);
        let xs = || edges.iter().flatten().map(|end| end.x);
        let left = xs().fold(f64::INFINITY, f64::min);
        let right = xs().fold(left, f64::max);
        if !left.is_finite() {
            return;
        }
        let size = [(right - left) as usize + 2, label_px(self.font_px) as usize];
        let mut rasterizer = Rasterizer::new(size[0], size[1]);
        for ends in edges {
            let [from, to] = ends.map(|end| {
                let down = f64::from(self.font_px) - end.y;
                point((end.x - left) as f32, down as f32)
            });
            rasterizer.draw_line(from, to);
        }
        rasterizer.for_each_pixel_2d(|column, row, coverage| {
            if (column as usize) < most {
                let start = self.offset(x + column, y + row);
                let pixel = &mut self.pixels[start..start + 4];
                for (pixel, ink) in pixel.iter_mut().zip(INK) {
                    let more = (f32::from(ink) - f32::from(*pixel)) * coverage.min(1.0);
                    *pixel = (f32::from(*pixel) + more).round() as u8;
                }
            }
        });
    }
}

/// Height of a label and the gap above it, pixels.
fn label_px(font_px: u32) -> u32 {
    font_px + font_px / 4 + GAP_PX
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn pictures_stand_in_rows_with_their_labels() {
        let cell = [24, 10];
        let mut page = Page::new(cell, 3, 2).expect("small");
        assert_eq!(page.size, [8 + 2 * 32, 8 + 2 * 41]);
        let red = [255, 0, 0, 255].repeat(240);
        page.put(2, &red, "I and more");
        let at = |x: u32, y: u32| {
            let start = page.offset(x, y);
            [0, 1, 2].map(|i| page.pixels[start + i])
        };
        let first_of_row = 8 + 41;
        assert_eq!(
            [at(8, first_of_row), at(31, first_of_row + 9)],
            [[255, 0, 0]; 2]
        );
        assert_eq!(at(32, first_of_row), [32; 3]);
        // The label is below, and no wider than the picture.
        let inked = (0..page.size[0] * page.size[1])
            .map(|i| (i % page.size[0], i / page.size[0]))
            .filter(|(x, y)| at(*x, *y).iter().all(|part| (33..=235).contains(part)));
        let inked: Vec<_> = inked.collect();
        let below = first_of_row + 10..first_of_row + 33;
        // Edges are smooth, and a stem is as bright as the ink.
        let shades: BTreeSet<_> = inked.iter().map(|(x, y)| at(*x, *y)[0]).collect();
        assert!(shades.len() > 8 && shades.last() > Some(&180), "{shades:?}");
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
