//! Generated pictures, the same as in `tests/tools/test_metric_reference.py`.

use reflet::metric::Scores;

use super::*;

/// Smooth color waves, a checker and deterministic noise, 8-bit RGB.
pub fn generated(width: usize, height: usize, seed: u64) -> Vec<u8> {
    let value = |x: u64, y: u64, c: u64| {
        let h = x * 73_856_093 + y * 19_349_663 + c * 83_492_791 + seed * 2_654_435_761;
        let h = (h ^ (h >> 13)).wrapping_mul(1_274_126_177) & 0xFFFF_FFFF;
        let noise = (h ^ (h >> 16)) & 31;
        let wave = (x * (3 + c) + y * 2) & 127;
        let checker = (((x >> 3) + (y >> 3)) & 1) * 64;
        (noise + wave + checker) as u8
    };
    let mut rgb = Vec::with_capacity(3 * width * height);
    for y in 0..height as u64 {
        for x in 0..width as u64 {
            rgb.extend((0..3).map(|c| value(x, y, c)));
        }
    }
    rgb
}

/// An 8-bit picture.
pub fn picture(width: usize, height: usize, rgb: &[u8]) -> Picture {
    Picture::from_rgb8(width, height, rgb).expect("a whole picture")
}

/// A picture of one color.
pub fn flat(width: usize, height: usize, encoding: Encoding, color: [f32; 3]) -> Picture {
    Picture::new(width, height, encoding, vec![color; width * height]).expect("a whole picture")
}

/// All metrics of a pair.
pub fn scores(test: &Picture, reference: &Picture, mask: Option<&Mask>) -> Scores {
    Maps::compare(&Pair::new(test, reference).expect("one size")).scores(mask)
}

/// Pseudo-random numbers from 0 to 2³² − 1 (xorshift; Marsaglia 2003).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 >> 32
    }

    pub fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.next() as u8).collect()
    }
}
