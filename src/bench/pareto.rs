//! Pareto front of time against error, and break-even of marching and tracing.

/// Milliseconds and error of one setting; less of both is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Time, milliseconds.
    pub ms: f64,
    /// Error, in the metric's unit.
    pub error: f64,
}

impl Spot {
    /// Whether `other` is at least as good in both quantities and better in one.
    fn is_dominated_by(&self, other: &Self) -> bool {
        other.ms <= self.ms
            && other.error <= self.error
            && (other.ms < self.ms || other.error < self.error)
    }
}

/// For each spot whether it is on the Pareto front: no other dominates it.
pub fn pareto_front(spots: &[Spot]) -> Vec<bool> {
    let is_free = |spot: &Spot| !spots.iter().any(|other| spot.is_dominated_by(other));
    spots.iter().map(is_free).collect()
}

/// Index of the smallest error among spots that take at most `ms`; of equals the fastest.
pub fn best_within(spots: &[Spot], ms: f64) -> Option<usize> {
    least(spots, |s| s.ms <= ms, |s| (s.error, s.ms))
}

/// Index of the fastest spot that errs at most `error`; of equally fast spots, the more accurate one.
pub fn cheapest_within(spots: &[Spot], error: f64) -> Option<usize> {
    least(spots, |s| s.error <= error, |s| (s.ms, s.error))
}

fn least(
    spots: &[Spot],
    allowed: impl Fn(&Spot) -> bool,
    rank: impl Fn(&Spot) -> (f64, f64),
) -> Option<usize> {
    let candidates = spots.iter().enumerate().filter(|(_, spot)| allowed(spot));
    let order = |a: &Spot, b: &Spot| {
        let (a, b) = (rank(a), rank(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    };
    candidates
        .min_by(|(_, a), (_, b)| order(a, b))
        .map(|(i, _)| i)
}

/// Inputs of break-even, measured with the same size, ray length and bounces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// Time of marching beyond the time of a frame without it, milliseconds.
    pub march_ms: f64,
    /// Time to trace every marchable pixel, milliseconds.
    pub full_trace_ms: f64,
    /// Time to trace the rays that `hybrid` leaves after marching, and to shade its hits, milliseconds.
    pub partial_trace_ms: f64,
    /// Number of rays of `hybrid`.
    pub partial_rays: f64,
    /// Number of rays of `rt`.
    pub full_rays: f64,
}

/// Share of the rays at which `hybrid` costs as much as `rt`: below it marching first pays.
/// Under 0 it never pays, over 1 always. None where `rt` traces nothing.
///
/// The time of tracing and shading is interpolated by the share of rays, between `hybrid` as measured and `rt`, whose
/// share is 1: all hits of the march are shaded, so that a ray less saves its traversal alone.
pub fn break_even_share(costs: &Costs) -> Option<f64> {
    if costs.full_rays <= 0.0 || costs.full_trace_ms <= 0.0 {
        return None;
    }
    let saved_share = 1.0 - costs.partial_rays / costs.full_rays;
    let saved_ms = costs.full_trace_ms - costs.partial_trace_ms;
    if saved_ms <= 0.0 || saved_share <= 0.0 {
        return Some(0.0);
    }
    Some(1.0 - costs.march_ms * saved_share / saved_ms)
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn spot(ms: f64, error: f64) -> Spot {
        Spot { ms, error }
    }

    const SPOTS: [Spot; 6] = [
        spot(1.0, 0.5),
        spot(2.0, 0.2),
        spot(2.0, 0.3), // as slow as its predecessor, and worse
        spot(3.0, 0.2), // as good, slower
        spot(4.0, 0.0),
        spot(5.0, 0.6),
    ];

    #[test]
    fn the_front_is_what_nothing_dominates() {
        assert_eq!(
            pareto_front(&SPOTS),
            [true, true, false, false, true, false]
        );
        // Equal spots do not dominate each other.
        assert_eq!(pareto_front(&[SPOTS[0], SPOTS[0]]), [true, true]);
        assert!(pareto_front(&[]).is_empty());
    }

    #[test]
    fn bounds_choose_the_best_that_meets_them() {
        assert_eq!(best_within(&SPOTS, 3.5), Some(1));
        assert_eq!(best_within(&SPOTS, 0.5), None);
        assert_eq!(cheapest_within(&SPOTS, 0.25), Some(1));
        assert_eq!(cheapest_within(&SPOTS, 0.1), Some(4));
        assert_eq!(cheapest_within(&SPOTS, -1.0), None);
    }

    #[test]
    fn break_even_is_where_both_cost_the_same() {
        let costs = Costs {
            march_ms: 2.0,
            full_trace_ms: 10.0,
            partial_trace_ms: 3.0,
            partial_rays: 200.0,
            full_rays: 1000.0,
        };
        let share = break_even_share(&costs).expect("rays");
        let hybrid_ms = costs.march_ms + 3.0 + (share - 0.2) / (1.0 - 0.2) * (10.0 - 3.0);
        assert!((hybrid_ms - 10.0).abs() < 1e-12 && share < 1.0);
        let slow = Costs {
            march_ms: 11.0,
            ..costs
        };
        assert!(break_even_share(&slow).expect("rays") < 0.0);
        // Where `hybrid` saves no time of tracing, marching never pays.
        let idle = Costs {
            partial_trace_ms: 10.0,
            ..costs
        };
        assert_eq!(break_even_share(&idle), Some(0.0));
        let nothing = Costs {
            full_rays: 0.0,
            ..costs
        };
        assert_eq!(break_even_share(&nothing), None);
    }
}
