//! Pixels of a sub-frame that show one moment of an open shutter.
//!
//! With one moment a sub-frame, pictures of few sub-frames show a moving thing several times (strobing). So a sub-frame
//! shows four moments, each in one pixel of every square of 2 × 2: neighbors see different moments, and the copies
//! become grain (interleaved sampling, Keller and Heidrich 2001). Each moment is posed and drawn whole, since the depth
//! test and the march need all pixels, but light is computed only for the pixels that show it.

use super::offsets::shutter_moment;

/// Number of moments of a sub-frame where pixels of one sub-frame show different ones.
pub const MOMENTS: u32 = 4;
/// Largest number of sub-frames of pictures whose sub-frames show several moments each; more show enough.
const FEW_SAMPLES: u32 = 16;

/// Whether pictures of so many sub-frames show several moments in each while the shutter is open.
pub fn needs_moments(samples: u32) -> bool {
    samples <= FEW_SAMPLES
}

/// Pixels of one sub-frame that show one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelShare {
    /// Index of the sub-frame.
    pub sample: u32,
    /// Number of moments of the sub-frame: 1 for all pixels, or [`MOMENTS`].
    pub moments: u32,
    /// Index of the moment within the sub-frame. They are rendered in falling order.
    pub moment: u32,
}

impl PixelShare {
    /// All pixels of a sub-frame.
    pub fn all(sample: u32) -> Self {
        Self {
            sample,
            moments: 1,
            moment: 0,
        }
    }

    /// The shares of a sub-frame of so many moments, in the order in which they are rendered.
    pub fn of_sub_frame(sample: u32, moments: u32) -> impl Iterator<Item = Self> {
        let share = move |moment| Self {
            sample,
            moments,
            moment,
        };
        (0..moments).rev().map(share)
    }

    /// Whether it is the first share of its sub-frame.
    pub fn is_first(&self) -> bool {
        self.moment + 1 == self.moments
    }

    /// Whether it is the last share of its sub-frame.
    pub fn is_last(&self) -> bool {
        self.moment == 0
    }

    /// Moment within the time that the shutter is open, -0.5 to 0.5, in a picture of `samples` sub-frames.
    pub fn moment_of(&self, samples: u32) -> f64 {
        shutter_moment(self.sample, samples, self.moment, self.moments)
    }

    /// Width and height of the picture in squares, of which each has one pixel of the share.
    pub fn squares(&self, size: [u32; 2]) -> [u32; 2] {
        match self.moments {
            1 => size,
            _ => size.map(|side| side.div_ceil(2)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_fill_the_shutter_evenly_and_end_in_its_middle() {
        for samples in [1, 2, 3, 4, 7, 15, 16, 17, 100] {
            let moments = if needs_moments(samples) { MOMENTS } else { 1 };
            let shares: Vec<_> = (0..samples)
                .flat_map(|sample| PixelShare::of_sub_frame(sample, moments))
                .collect();
            let last = shares.last().expect("at least one");
            assert_eq!((last.sample, last.moment_of(samples)), (samples - 1, 0.0));
            assert!(shares[0].is_first() && last.is_last());
            let mut moments: Vec<_> = shares.iter().map(|s| s.moment_of(samples)).collect();
            moments.extend([-0.5, 0.5]);
            moments.sort_by(f64::total_cmp);
            let gaps = moments.windows(2).map(|pair| pair[1] - pair[0]);
            let widest = gaps.fold(0.0, f64::max);
            let even = 1.0 / shares.len() as f64;
            assert!(widest < 4.0 * even, "{samples}: {widest}");
        }
    }
}
