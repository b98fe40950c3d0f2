//! A picture to be compared: finite, non-negative colors and their encoding.

use rayon::prelude::*;

use reflet_base::math::{linear_from_srgb, srgb_from_linear};

/// Encoding of the numbers of a [`Picture`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// sRGB code values from 0 to 255; pictures with 16 bits keep their fractions.
    Display,
    /// Linear radiance, 1 is the white of the display; may exceed 1.
    Linear,
}

/// An RGB picture whose numbers are all finite and not negative.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    encoding: Encoding,
    pixels: Vec<[f32; 3]>,
}

/// Reason why numbers are no picture, or two pictures no pair.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// The number of pixels is 0, or not width × height.
    #[error("{pixels} pixels given for a picture of {width} × {height}")]
    Shape {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
        /// Number of given pixels.
        pixels: usize,
    },
    /// Pixels that hold NaN, an infinity or a negative number.
    #[error(
        "{count} {} NaN, an infinity or a negative number, the first at column {}, row {}: {value}",
        if *count == 1 { "pixel holds" } else { "pixels hold" }, first[0], first[1]
    )]
    Value {
        /// Number of such pixels.
        count: usize,
        /// Column and row of the first such pixel.
        first: [usize; 2],
        /// Its value.
        value: f32,
    },
    /// Two pictures (or a picture and a mask) of different sizes.
    #[error(
        "the sizes differ: {} × {} against {} × {} pixels; metrics compare pixel with pixel and never resample",
        first[0], first[1], second[0], second[1]
    )]
    Size {
        /// Size of the first, pixels.
        first: [usize; 2],
        /// Size of the second, pixels.
        second: [usize; 2],
    },
    /// FLIP in a browser, for which its authors' C++ is not built.
    #[cfg(target_arch = "wasm32")]
    #[error("browsers lack FLIP")]
    NoFlip,
}

impl Picture {
    /// Checks `pixels` (row by row from the top left) and wraps them.
    ///
    /// # Errors
    /// When there are no pixels, not `width * height`, or one is NaN, infinite or negative.
    pub fn new(
        width: usize,
        height: usize,
        encoding: Encoding,
        pixels: Vec<[f32; 3]>,
    ) -> Result<Self, PictureError> {
        if pixels.is_empty() || width.checked_mul(height) != Some(pixels.len()) {
            return Err(PictureError::Shape {
                width,
                height,
                pixels: pixels.len(),
            });
        }
        check_values(width, &pixels, |v| v.is_finite() && v >= 0.0)?;
        Ok(Self {
            width,
            height,
            encoding,
            pixels,
        })
    }

    /// An 8-bit sRGB picture from tightly packed RGB bytes.
    ///
    /// # Errors
    /// When `rgb` is not `3 * width * height` bytes.
    pub fn from_rgb8(width: usize, height: usize, rgb: &[u8]) -> Result<Self, PictureError> {
        let (pixels, rest) = rgb.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(PictureError::Shape {
                width,
                height,
                pixels: pixels.len(),
            });
        }
        let pixels = pixels.iter().map(|p| p.map(f32::from)).collect();
        Self::new(width, height, Encoding::Display, pixels)
    }

    /// Pixels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Encoding of the numbers.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The numbers as given, row by row from the top left.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// Converts to sRGB code values from 0 to 255, not rounded. Linear light is clamped at 1 and encoded with
    /// the sRGB transfer function (IEC 61966-2-1); there is no other tone mapping.
    pub fn display(&self) -> Vec<[f32; 3]> {
        match self.encoding {
            Encoding::Display => self.pixels.clone(),
            Encoding::Linear => {
                let code = |v: f32| {
                    if v >= 1.0 {
                        255.0 // exactly white, which single precision would miss
                    } else {
                        255.0 * srgb_from_linear(v)
                    }
                };
                self.pixels.par_iter().map(|p| p.map(code)).collect()
            }
        }
    }

    /// Converts to linear light. Code values are decoded with the sRGB transfer function.
    pub fn linear(&self) -> Vec<[f32; 3]> {
        match self.encoding {
            Encoding::Linear => self.pixels.clone(),
            Encoding::Display => {
                let table: Vec<f32> = (0..=255)
                    .map(|code| linear_from_srgb(code as f32 / 255.0))
                    .collect();
                let decode = |v: f32| {
                    if v.fract() == 0.0 && v <= 255.0 {
                        table[v as usize]
                    } else {
                        linear_from_srgb(v / 255.0)
                    }
                };
                self.pixels.iter().map(|p| p.map(decode)).collect()
            }
        }
    }

    /// The largest channel of every pixel as a weight, for masks. Code values count as data
    /// (255 is 1), not as color.
    pub fn weights(&self) -> Vec<f32> {
        let scale = match self.encoding {
            Encoding::Display => 255.0,
            Encoding::Linear => 1.0,
        };
        let largest = |p: &[f32; 3]| p[0].max(p[1]).max(p[2]);
        self.pixels.iter().map(|p| largest(p) / scale).collect()
    }

    /// Number of pixels with a channel over display white, which display metrics cannot distinguish.
    pub fn over_white(&self) -> usize {
        match self.encoding {
            Encoding::Display => 0,
            Encoding::Linear => self
                .pixels
                .iter()
                .filter(|p| p.iter().any(|v| *v > 1.0))
                .count(),
        }
    }
}

/// Finds pixels with a value that `valid` refuses.
pub(super) fn check_values<const N: usize>(
    width: usize,
    pixels: &[[f32; N]],
    valid: impl Fn(f32) -> bool,
) -> Result<(), PictureError> {
    let bad = |p: &[f32; N]| p.iter().copied().find(|v| !valid(*v));
    let mut found = pixels
        .iter()
        .enumerate()
        .filter_map(|(i, p)| bad(p).map(|v| (i, v)));
    match found.next() {
        None => Ok(()),
        Some((i, value)) => Err(PictureError::Value {
            count: 1 + found.count(),
            first: [i % width, i / width],
            value,
        }),
    }
}

/// A test picture and its reference, of one size.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    test: &'a Picture,
    reference: &'a Picture,
}

impl<'a> Pair<'a> {
    /// Pairs two pictures.
    ///
    /// # Errors
    /// When their sizes differ.
    pub fn new(test: &'a Picture, reference: &'a Picture) -> Result<Self, PictureError> {
        let size = |p: &Picture| [p.width, p.height];
        if size(test) != size(reference) {
            return Err(PictureError::Size {
                first: size(test),
                second: size(reference),
            });
        }
        Ok(Self { test, reference })
    }

    /// The picture under test.
    pub fn test(&self) -> &'a Picture {
        self.test
    }

    /// The reference picture.
    pub fn reference(&self) -> &'a Picture {
        self.reference
    }
}
