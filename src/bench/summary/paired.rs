//! Paired comparison of two settings that were timed in alternation, frame by frame: the faster one, if
//! the frames decide at all. A median alone cannot tell that.

use std::collections::BTreeMap;

use crate::sample::Sample;
use reflet_render::{passes::trace, pipeline::pass::PassGroup};

/// Pairs of frames below which no two settings can be told apart by [`Pairs::order`].
pub const MIN_PAIRS: usize = 6;

/// One timed frame of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// Frame of the animation, and number of the repetition.
    pub frame_repetition: (u32, u32),
    /// Milliseconds of the frame, as [`super::Point::ms`] counts them.
    pub ms: f64,
    /// Milliseconds of marching and listing rays.
    pub march_ms: f64,
    /// Milliseconds of tracing and of shading hits.
    pub trace_ms: f64,
    /// Number of traced rays.
    pub rays: f64,
}

impl Timed {
    pub(super) fn from_sample(sample: &Sample, ms: f64) -> Self {
        Self {
            frame_repetition: (sample.frame, sample.repetition),
            ms,
            march_ms: sample.group_ms(PassGroup::March),
            trace_ms: sample.pass_ms(&trace::PASS),
            rays: sample.rays as f64,
        }
    }
}

/// Order of two settings by time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// The first setting is faster.
    Faster,
    /// The first setting is slower.
    Slower,
    /// The difference can be chance.
    Undecided,
}

/// Numbers of paired frames of two settings, by the setting that was faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pairs {
    /// Number of pairs in which the first was faster.
    pub faster: usize,
    /// Number of pairs in which the first was slower.
    pub slower: usize,
}

/// Pairs of frames of two settings with the same frame number and repetition.
pub fn pairs<'a>(a: &'a [Timed], b: &'a [Timed]) -> impl Iterator<Item = (&'a Timed, &'a Timed)> {
    let b: BTreeMap<(u32, u32), &Timed> = b
        .iter()
        .map(|timed| (timed.frame_repetition, timed))
        .collect();
    let both = a
        .iter()
        .map(move |a| Some((a, *b.get(&a.frame_repetition)?)));
    both.flatten()
}

impl Pairs {
    /// Counts the pairs of two settings.
    pub fn count(a: &[Timed], b: &[Timed]) -> Self {
        let [mut faster, mut slower] = [0; 2];
        for (a, b) in pairs(a, b) {
            faster += usize::from(a.ms < b.ms);
            slower += usize::from(a.ms > b.ms);
        }
        Self { faster, slower }
    }

    /// Sign test (Dixon and Mood 1946), two-sided at 5 %: whether one setting is faster more often
    /// than chance explains.
    pub fn order(self) -> Order {
        if sign_test(self.faster, self.slower) >= 0.05 {
            Order::Undecided
        } else if self.faster > self.slower {
            Order::Faster
        } else {
            Order::Slower
        }
    }

    /// Number of pairs without a tie.
    pub fn n(self) -> usize {
        self.faster + self.slower
    }
}

/// Probability of a result at least as uneven if both settings were equally likely to be faster.
fn sign_test(a: usize, b: usize) -> f64 {
    let (n, k) = (a + b, a.min(b));
    if n > 1000 {
        // The normal approximation of the binomial; 1.96 standard deviations leave 5 % outside.
        let z = (a.abs_diff(b) as f64 - 1.0) / (n as f64).sqrt();
        return if z > 1.96 { 0.0 } else { 1.0 };
    }
    let mut term = 0.5_f64.powi(n as i32);
    let mut tail = term;
    for i in 0..k {
        term *= (n - i) as f64 / (i + 1) as f64;
        tail += term;
    }
    (2.0 * tail).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timed(ms: &[f64]) -> Vec<Timed> {
        let of = |(i, &ms): (usize, &f64)| Timed {
            frame_repetition: (0, i as u32),
            ms,
            march_ms: 0.0,
            trace_ms: 0.0,
            rays: 0.0,
        };
        ms.iter().enumerate().map(of).collect()
    }

    #[test]
    fn the_sign_test_has_the_tails_of_the_binomial() {
        // 2 · (1 + 6) / 2^6, 2 / 2^6, and 2 · Σ C(20, 0..=5) / 2^20.
        assert_eq!(sign_test(5, 1), 14.0 / 64.0);
        assert_eq!(sign_test(0, 6), 2.0 / 64.0);
        assert!((sign_test(5, 15) - 2.0 * 21_700.0 / 1_048_576.0).abs() < 1e-15);
        assert_eq!((sign_test(10, 10), sign_test(0, 0)), (1.0, 1.0));
        assert!(sign_test(470, 531) >= 0.05 && sign_test(440, 561) < 0.05);
    }

    #[test]
    fn settings_are_compared_in_the_turns_they_share() {
        // The machine slows down meanwhile: medians overlap, pairs do not.
        let a = timed(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let b = timed(&[1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 0.1]);
        let pairs = Pairs::count(&a, &b);
        assert_eq!((pairs.faster, pairs.slower, pairs.n()), (6, 0, 6));
        assert_eq!(pairs.order(), Order::Faster);
        assert_eq!(Pairs::count(&b, &a).order(), Order::Slower);
        assert_eq!(Pairs::count(&a[..5], &b).order(), Order::Undecided);
        assert_eq!(Pairs::count(&a, &a).n(), 0);
    }
}
