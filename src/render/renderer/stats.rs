//! Statistics of a frame: its cost, and the sources of its reflections.

use serde::{Serialize, ser::SerializeStruct as _};

use reflet_scene::desc::Method;

use super::error_estimate::ErrorEstimate;
use crate::{
    decide::Decision,
    maps::method_maps::{MapStats, as_map},
    methods::second_layer::stats::SecondLayer,
    passes::trace,
    pipeline::{
        cause::{Cause, Source},
        ray_list::{
            AUDITED_COUNTER, COUNTERS, EXHAUSTED_COUNTER, FOLLOWER_COUNTER, RAY_COUNTER,
            REST_COUNTER, WRONG_COUNTER,
        },
    },
};

/// Counts of pixels by cause and by source.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Shares {
    /// Number of pixels of the picture.
    pub pixels: u64,
    /// Number of pixels that reflect.
    pub reflective: u64,
    /// Number of pixels of each cause but `not_reflective`, with the percentage of all reflective pixels.
    pub causes: Vec<Share>,
    /// Number of pixels by source: screen + traced (failed with method `ssr`, sources of their own with methods that
    /// have maps) + none + rough = 100 %.
    pub sources: Vec<Share>,
}

/// One class of reflective pixels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Name of the cause or source.
    pub name: &'static str,
    /// Number of pixels.
    pub pixels: u64,
    /// Percentage of all reflective pixels.
    pub percent: f64,
}

impl Shares {
    /// Shares from the counters of a frame.
    pub fn new(counters: &[u32], size: [u32; 2], method: Method) -> Self {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let counter = |cause: Cause| u64::from(counters.get(cause as usize).copied().unwrap_or(0));
        // Pixels are counted as not marched when they are listed, and again where their rays end in maps.
        let count = |cause: Cause| match cause {
            Cause::Unmarched if !method.marches() && method.traces() => {
                let ended = Cause::ALL.into_iter().filter(|c| c.is_end_in_maps());
                counter(cause).saturating_sub(ended.map(counter).sum())
            }
            _ => counter(cause),
        };
        let reflecting = || {
            Cause::ALL
                .into_iter()
                .filter(|c| *c != Cause::NotReflective)
        };
        let reflective: u64 = reflecting().map(count).sum();
        let share = |name, pixels: u64| Share {
            name,
            pixels,
            percent: if reflective == 0 {
                0.0
            } else {
                100.0 * pixels as f64 / reflective as f64
            },
        };
        let source = |source: Source| {
            share(
                source.name(),
                reflecting()
                    .filter(|c| c.source(method) == source)
                    .map(count)
                    .sum(),
            )
        };
        let maps = Source::ALL.into_iter().filter(|source| source.is_map());
        Self {
            pixels,
            reflective,
            causes: reflecting().map(|c| share(c.name(), count(c))).collect(),
            sources: [Source::Screen, Source::Traced]
                .into_iter()
                .chain(maps)
                .chain([Source::Failed, Source::None, Source::Rough])
                .map(source)
                .collect(),
        }
    }
}

/// Screen hits that were checked by tracing their rays: all of them, or a random choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Audit {
    /// Number of checked hits.
    pub hits: u32,
    /// Number of screen hits that they were drawn from.
    pub of: u32,
    /// Number of checked hits where the ray hits nothing, another instance, or the same one elsewhere; see
    /// [`TOLERANCE_U`](crate::passes::audit::TOLERANCE_U).
    pub wrong: u32,
}

impl std::iter::Sum for Audit {
    fn sum<I: Iterator<Item = Self>>(audits: I) -> Self {
        audits.fold(Self::default(), |sum, audit| Self {
            hits: sum.hits + audit.hits,
            of: sum.of + audit.of,
            wrong: sum.wrong + audit.wrong,
        })
    }
}

impl Audit {
    /// Share of wrong hits, 0 to 1: the measured value, and its 95 % confidence interval (Wilson 1927) where not every
    /// hit was checked.
    pub fn wrong_share(&self) -> (f64, Option<[f64; 2]>) {
        const Z: f64 = 1.959_964;
        let n = f64::from(self.hits.max(1));
        let share = f64::from(self.wrong) / n;
        let middle = share + Z * Z / (2.0 * n);
        let reach = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
        let scale = 1.0 + Z * Z / n;
        let ends = [middle - reach, middle + reach].map(|end| (end / scale).clamp(0.0, 1.0));
        (share, (self.hits < self.of).then_some(ends))
    }
}

impl Serialize for Audit {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (wrong_share, interval) = self.wrong_share();
        let mut fields = serializer.serialize_struct("Audit", 5)?;
        fields.serialize_field("hits", &self.hits)?;
        fields.serialize_field("of", &self.of)?;
        fields.serialize_field("wrong", &self.wrong)?;
        fields.serialize_field("wrong_share", &wrong_share)?;
        fields.serialize_field("interval_95", &interval)?;
        fields.end()
    }
}

impl std::fmt::Display for Audit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { hits, wrong, .. } = self;
        let (share, interval) = self.wrong_share();
        let permille = 1e3 * share;
        match interval.map(|ends| ends.map(|end| 1e3 * end)) {
            Some([low, high]) => write!(
                f,
                "{permille:.1} ‰ of the screen hits are wrong (95 %: {low:.1} to {high:.1} ‰; {wrong} of {hits} traced)",
            ),
            None => write!(
                f,
                "{permille:.1} ‰ of the screen hits are wrong ({wrong} of {hits}; all were traced)",
            ),
        }
    }
}

/// Statistics of one rendered picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrameStats {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Number of sub-frames.
    pub samples: u32,
    /// Estimated error, where `samples` is chosen by an error bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorEstimate>,
    /// Method that found the reflections.
    #[serde(serialize_with = "method_name")]
    pub method: Method,
    /// Settings that were left to `auto`, with the chosen values.
    pub decisions: Vec<Decision>,
    /// The length U, meters.
    pub unit_m: f32,
    /// Time to build all BVHs on the CPU, milliseconds.
    pub tree_ms: f64,
    /// Time in which the device built its structures for ray queries, milliseconds: processor time on software
    /// adapters; 0 without ray queries.
    pub structures_ms: f64,
    /// Time of their last update for instances that moved and meshes that deformed, milliseconds; it is not part of the
    /// times of the frame's passes. 0 where nothing moved yet.
    pub structures_update_ms: f64,
    /// GPU time of each pass over all sub-frames, milliseconds; empty where nothing was timed.
    #[serde(serialize_with = "as_map")]
    pub passes_ms: Vec<(String, f64)>,
    /// CPU time of the process during each pass, milliseconds, on a software adapter where the system tells it;
    /// empty elsewhere. Other programs do not lengthen it.
    #[serde(serialize_with = "as_map", skip_serializing_if = "Vec::is_empty")]
    pub processor_ms: Vec<(String, f64)>,
    /// Time from the first submission to the last finished pixel, milliseconds; 0 where nothing was timed.
    pub frame_ms: f64,
    /// Pixels by cause and source, in the last sub-frame.
    pub shares: Shares,
    /// Number of rays traced from pixels in the last sub-frame, without further bounces.
    pub rays: u32,
    /// Number of rays of the last sub-frame, shadow rays among them, that ran out of nodes or transmissive surfaces to
    /// pass and count as misses: 0 except in scenes of thousands of overlapping instances.
    pub exhausted_rays: u32,
    /// Result of the audit of the last sub-frame's screen hits, where the options ask for it and there were hits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub audit: Option<Audit>,
    /// Work of the second depth layer in the last sub-frame, where there is one and rays went behind the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_layer: Option<SecondLayer>,
    /// Maps of the frame's method, if it captures some.
    #[serde(flatten)]
    pub maps: Option<MapStats>,
    /// Size of every buffer and texture class, bytes.
    #[serde(serialize_with = "as_map")]
    pub bytes: Vec<(String, u64)>,
}

impl FrameStats {
    /// Sets the statistics that follow from the counters of the last sub-frame, one block for each of its moments.
    pub fn set_counters(&mut self, counters: &[u32]) {
        let mut sums = vec![0; COUNTERS];
        for moment in counters.chunks(COUNTERS) {
            for (sum, count) in sums.iter_mut().zip(moment) {
                *sum += count;
            }
        }
        let counters = sums.as_slice();
        self.shares = Shares::new(counters, self.size, self.method);
        self.exhausted_rays = counters.get(EXHAUSTED_COUNTER).copied().unwrap_or(0);
        self.second_layer = SecondLayer::from_counters(counters);
        let counter = |index: usize| counters.get(index).copied().unwrap_or(0);
        let (hits, wrong) = (counter(AUDITED_COUNTER), counter(WRONG_COUNTER));
        // The list of hits holds rays past all surfaces too where there is fog.
        let is_hit = |cause: &Cause| cause.source(self.method) == Source::Screen;
        let screen = Cause::ALL.into_iter().filter(is_hit);
        let of = screen.map(|cause| counter(cause as usize)).sum();
        self.audit = (hits > 0).then_some(Audit { hits, of, wrong });
        if self.method.traces() {
            self.rays = counter(RAY_COUNTER) - counter(FOLLOWER_COUNTER) + counter(REST_COUNTER);
        }
    }

    /// Bytes of the maps that are captured apart from the frame, and milliseconds of their last capture; `None` where
    /// there are none.
    pub fn captured(&self) -> Option<(u64, f64)> {
        (self.maps.as_ref()).map(|maps| (maps.facts.bytes, maps.capture_ms))
    }

    /// Bytes of the structures of ray queries, 0 where the driver does not tell; `None` without queries.
    pub fn structure_bytes(&self) -> Option<u64> {
        let is_theirs = |(name, _): &&(String, u64)| name == "ray_structures";
        let bytes = self.bytes.iter().find(is_theirs).map_or(0, |(_, b)| *b);
        (self.structures_ms > 0.0).then_some(bytes)
    }

    /// Time in which maps were captured, or structures of ray queries updated, for this picture, milliseconds; it is
    /// not part of the times of its passes.
    pub fn prepared_ms(&self) -> f64 {
        self.maps.as_ref().map_or(0.0, |maps| maps.update_ms) + self.structures_update_ms
    }

    /// Sum of the times of all passes, milliseconds.
    pub fn passes_total_ms(&self) -> f64 {
        self.passes_ms.iter().map(|(_, ms)| ms).sum()
    }

    /// Cost of each pass, milliseconds: CPU time where it is known, else GPU or wall time.
    pub fn costs_ms(&self) -> &[(String, f64)] {
        match self.processor_ms.as_slice() {
            [] => &self.passes_ms,
            passes => passes,
        }
    }

    /// Cost of all passes, milliseconds.
    pub fn cost_ms(&self) -> f64 {
        self.costs_ms().iter().map(|(_, ms)| ms).sum()
    }

    /// Whether the passes' sum and the time of the whole frame differ by more than 10 %; then neither should be
    /// quoted alone.
    pub fn times_disagree(&self) -> bool {
        !self.passes_ms.is_empty()
            && (self.passes_total_ms() - self.frame_ms).abs() > 0.1 * self.frame_ms
    }

    /// Rays per second of the trace pass, if it was timed, follows all rays, and shades no hits of a march or of other rays
    /// beside them.
    pub fn rays_per_s(&self) -> Option<f64> {
        let ms_of = |pass: &str| {
            let mut times = self.passes_ms.iter();
            times.find_map(|(name, ms)| (name == pass).then_some(*ms))
        };
        if self.method.marches() || ms_of(trace::LEADERS.name).is_some() {
            return None;
        }
        let ms = ms_of(trace::PASS.name)?;
        (ms > 0.0 && self.rays > 0)
            .then(|| f64::from(self.rays) * f64::from(self.samples) / (ms * 1e-3))
    }
}

fn method_name<S: serde::Serializer>(method: &Method, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(method.name())
}

#[cfg(test)]
mod tests {
    use super::Audit;

    #[test]
    fn a_count_of_all_hits_has_no_interval() {
        let audit = Audit {
            hits: 20,
            of: 20,
            wrong: 3,
        };
        assert_eq!(audit.wrong_share(), (0.15, None));
        assert!(audit.to_string().contains("3 of 20; all were traced"));
        // Frames of which some were not checked wholly leave the sum uncertain.
        let sampled = Audit {
            hits: 20,
            of: 40,
            wrong: 3,
        };
        let (_, interval) = [audit, sampled].into_iter().sum::<Audit>().wrong_share();
        assert!(interval.is_some());
    }

    /// Values of Newcombe 1998, table I, method 3.
    #[test]
    fn the_interval_is_wilsons() {
        for (wrong, hits, want) in [
            (81, 263, [0.2553, 0.3662]),
            (15, 148, [0.0624, 0.1605]),
            (0, 20, [0.0, 0.1611]),
            (1, 29, [0.0061, 0.1718]),
        ] {
            let of = hits + 1;
            let (share, interval) = Audit { hits, of, wrong }.wrong_share();
            let interval = interval.expect("some were not checked");
            assert!((share - f64::from(wrong) / f64::from(hits)).abs() < 1e-12);
            for (found, want) in interval.iter().zip(want) {
                assert!(
                    (found - want).abs() < 5e-5,
                    "{wrong} of {hits}: {interval:?}"
                );
            }
        }
    }
}
