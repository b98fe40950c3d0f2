//! Quantities of pairs: a frame and the frame before it, a trace pass and the same rays without
//! shading.

use std::collections::{BTreeMap, BTreeSet};

use super::{Spread, label};
use crate::sample::Sample;
use reflet_metric::temporal;
use reflet_render::passes::trace;

/// Temporal error over the measured frames of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlickerRatio {
    /// Σ |Δtest − Δreference| over Σ |Δreference|: 0 when the picture changes exactly as the
    /// reference does, 1 when its wrong change is as large as the reference's change.
    pub ratio: f64,
    /// Number of pairs of frames, the same for every setting.
    pub pairs: usize,
    /// Least and most distance of the two frames of a pair, frames.
    pub stride: [u32; 2],
}

impl FlickerRatio {
    /// Ratio over the given pairs of a frame and the measured frame before it.
    pub(super) fn from_pairs(samples: &[&Sample], pairs: &BTreeSet<(u32, u32)>) -> Option<Self> {
        let mut changes: BTreeMap<(u32, u32), [f64; 2]> = BTreeMap::new();
        for s in samples {
            let pair = s.since_frame.map(|since| (since, s.frame));
            if let (Some(pair), Some(difference), Some(change)) =
                (pair, s.temporal_difference, s.temporal_change)
                && pairs.contains(&pair)
            {
                changes.insert(pair, [difference, change]);
            }
        }
        let [difference, change] =
            [0, 1].map(|i| changes.values().map(|both| both[i]).sum::<f64>());
        let strides = changes.keys().map(|(since, frame)| frame.abs_diff(*since));
        Some(Self {
            ratio: temporal::ratio(changes.len(), difference, change)?,
            pairs: changes.len(),
            stride: [strides.clone().min()?, strides.max()?],
        })
    }
}

/// Pairs of a frame and the measured frame before it that all settings have.
pub(super) fn common_pairs(samples: &[&Sample]) -> BTreeSet<(u32, u32)> {
    let settings: BTreeSet<String> = samples.iter().map(|s| label(s)).collect();
    let mut has: BTreeMap<(u32, u32), BTreeSet<String>> = BTreeMap::new();
    for s in samples {
        if let (Some(since), Some(_)) = (s.since_frame, s.temporal_difference) {
            has.entry((since, s.frame)).or_default().insert(label(s));
        }
    }
    has.retain(|_, known| known.len() == settings.len());
    has.into_keys().collect()
}

/// Trace pass split into traversal and everything else, above all shading, from frames in which both
/// the pass and its rays without shading were timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Median milliseconds of the rays without shading.
    pub traverse_ms: f64,
    /// Median milliseconds that the pass took beyond traversal; none where that is not above 0, so that
    /// the two cannot be told apart.
    pub rest_ms: Option<f64>,
    /// Number of frames.
    pub n: usize,
    /// Number of frames in which the rays alone took longer than the whole pass.
    pub reversed: usize,
}

impl Split {
    pub(super) fn from_samples(samples: &[&Sample]) -> Option<Self> {
        let pair = |s: &&Sample| Some((s.traverse_ms?, s.pass_ms(&trace::PASS)));
        let pairs: Vec<(f64, f64)> = samples.iter().filter_map(pair).collect();
        let rest: Vec<f64> = pairs.iter().map(|(rays, all)| all - rays).collect();
        let reversed = rest.iter().filter(|ms| **ms < 0.0).count();
        let rest_ms = Spread::from_values(rest)?.median;
        Some(Self {
            traverse_ms: Spread::from_values(pairs.iter().map(|(rays, _)| *rays).collect())?.median,
            rest_ms: (rest_ms > 0.0).then_some(rest_ms),
            n: pairs.len(),
            reversed,
        })
    }
}
