//! Work of the second depth layer in a frame.

use serde::Serialize;

use crate::pipeline::{cause::Cause, ray_list::BEHIND_COUNTER};

/// Work of the second depth layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SecondLayer {
    /// Number of pixels whose ray went behind the first layer, which alone would call them hidden.
    pub behind: u32,
    /// Number of these rays that hit the second layer.
    pub hits: u32,
    /// The same as a percentage.
    pub hit_percent: f64,
}

impl SecondLayer {
    /// Work that the counters of a frame tell; `None` where no ray went behind a first layer with a second.
    pub(crate) fn from_counters(counters: &[u32]) -> Option<Self> {
        let counter = |index: usize| counters.get(index).copied().unwrap_or(0);
        let (behind, hits) = (counter(BEHIND_COUNTER), counter(Cause::HitBehind as usize));
        (behind > 0).then(|| Self {
            behind,
            hits,
            hit_percent: 100.0 * f64::from(hits) / f64::from(behind),
        })
    }
}

impl std::fmt::Display for SecondLayer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:.1} % of the {} rays that went behind the first layer hit the second",
            self.hit_percent, self.behind,
        )
    }
}
