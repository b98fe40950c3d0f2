//! A picture in memory, and the wipe of two.

use crate::viewer::view_channel::BACKGROUND_GRAY;

/// Width of the wipe line, pixels.
const LINE_PX: u32 = 2;

/// A picture in memory: RGBA, 8 bits a channel, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    pub size: [u32; 2],
    pub rgba: Vec<u8>,
}

/// The left side up to the line, the right one from there; each as large as fits its aspect ratio.
pub(super) fn compose_wipe(left: &Pixels, right: &Pixels, at: f32, size: [u32; 2]) -> Pixels {
    let line = (at.clamp(0.0, 1.0) * size[0] as f32).round() as u32;
    let line_x = line.saturating_sub(LINE_PX / 2)..line + LINE_PX / 2;
    let texel = |x: u32, y: u32| {
        if line_x.contains(&x) {
            return [255; 4];
        }
        let of = if x < line { left } else { right };
        sample(of, [x, y], size)
    };
    let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
    Pixels {
        size,
        rgba: pixels.flat_map(|(x, y)| texel(x, y)).collect(),
    }
}

/// The nearest texel for a pixel of a picture of this size into which `of` is fitted.
fn sample(of: &Pixels, pixel: [u32; 2], size: [u32; 2]) -> [u8; 4] {
    let scale = [0, 1]
        .map(|axis| size[axis] as f32 / of.size[axis].max(1) as f32)
        .into_iter()
        .fold(f32::INFINITY, f32::min);
    let [x, y] = [0, 1].map(|axis| {
        let free = size[axis] as f32 - of.size[axis] as f32 * scale;
        ((pixel[axis] as f32 + 0.5 - 0.5 * free) / scale).floor()
    });
    let is_there = x >= 0.0 && y >= 0.0 && x < of.size[0] as f32 && y < of.size[1] as f32;
    let at = 4 * (y as usize * of.size[0] as usize + x as usize);
    let texel = of.rgba.get(at..at + 4).filter(|_| is_there);
    texel.map_or(
        [BACKGROUND_GRAY, BACKGROUND_GRAY, BACKGROUND_GRAY, 255],
        |texel| [texel[0], texel[1], texel[2], texel[3]],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(size: [u32; 2], gray: u8) -> Pixels {
        Pixels {
            size,
            rgba: vec![gray; 4 * (size[0] * size[1]) as usize],
        }
    }

    fn reds(pixels: &Pixels, y: u32) -> Vec<u8> {
        let [width, _] = pixels.size;
        let row = (y * width) as usize..((y + 1) * width) as usize;
        row.map(|i| pixels.rgba[4 * i]).collect()
    }

    #[test]
    fn both_sides_and_the_line_are_written() {
        let (left, right) = (plain([8, 2], 10), plain([8, 2], 90));
        let whole = compose_wipe(&left, &right, 0.5, [8, 2]);
        assert_eq!(reds(&whole, 1), [10, 10, 10, 255, 255, 90, 90, 90]);
        assert_eq!(
            reds(&compose_wipe(&left, &right, 0.0, [8, 2]), 0)[1..],
            [90; 7]
        );
        assert_eq!(
            reds(&compose_wipe(&left, &right, 1.0, [8, 2]), 0)[..7],
            [10; 7]
        );
    }

    #[test]
    fn wipe_keeps_the_aspect_ratio_of_each_side() {
        let mut left = plain([2, 2], 10);
        left.rgba[..4].copy_from_slice(&[77; 4]);
        let whole = compose_wipe(&left, &plain([8, 4], 90), 0.999, [8, 4]);
        // The left side is scaled up twice and centered: four pixels wide, between margins.
        assert_eq!(reds(&whole, 0)[..7], [16, 16, 77, 77, 10, 10, 16]);
        assert_eq!(reds(&whole, 3)[..7], [16, 16, 10, 10, 10, 10, 16]);
    }
}
