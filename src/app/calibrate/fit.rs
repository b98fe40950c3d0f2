//! Least-squares fit of two unit costs to measured times.

/// A pass with the counts that its time is fitted to: time = first × cost + second × cost.
pub struct Measured {
    /// Two work counts of the pass, such as triangles and pixels.
    pub counts: [f64; 2],
    /// Measured time, nanoseconds.
    pub ns: f64,
}

/// Unit cost in place of one that the times do not show, nanoseconds: plan files must not contain zeros.
pub const LEAST_NS: f64 = 1e-4;

/// Costs, not below 0, that explain the times with the least sum of squared relative errors.
pub fn fit(measured: &[Measured]) -> [f64; 2] {
    let (mut xx, mut xy, mut yy, mut x, mut y) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for m in measured {
        let [a, b] = m.counts.map(|count| count / m.ns);
        xx += a * a;
        xy += a * b;
        yy += b * b;
        x += a;
        y += b;
    }
    let alone = |sum: f64, square: f64| if square > 0.0 { sum / square } else { 0.0 };
    let determinant = xx * yy - xy * xy;
    let both = [x * yy - y * xy, y * xx - x * xy].map(|v| v / determinant);
    let costs = if determinant > 1e-9 * xx * yy && both.iter().all(|cost| *cost >= 0.0) {
        both
    } else {
        // The counts are proportional, or a cost would be negative: only the count that explains more time is used.
        let [first, second] = [alone(x, xx), alone(y, yy)];
        if first * x >= second * y {
            [first, 0.0]
        } else {
            [0.0, second]
        }
    };
    costs.map(|cost| {
        if cost.is_finite() {
            cost.max(LEAST_NS)
        } else {
            LEAST_NS
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(costs: [f64; 2], counts: &[[f64; 2]]) -> Vec<Measured> {
        let of = |&[a, b]: &[f64; 2]| Measured {
            counts: [a, b],
            ns: a * costs[0] + b * costs[1],
        };
        counts.iter().map(of).collect()
    }

    #[test]
    fn fits_find_what_made_the_times() {
        let counts = [[1e3, 1e5], [1e5, 1e5], [1e3, 4e5], [1e5, 4e5]];
        let [a, b] = fit(&measured([90.0, 24.0], &counts));
        assert!(
            (a - 90.0).abs() < 1e-6 && (b - 24.0).abs() < 1e-6,
            "{a} {b}"
        );
        // One count is zero; both counts are proportional; nothing was measured.
        let [a, b] = fit(&measured([5.0, 0.0], &[[10.0, 0.0]]));
        assert!((a - 5.0).abs() < 1e-9 && b == LEAST_NS, "{a} {b}");
        let [a, b] = fit(&measured([1.0, 1.0], &[[1.0, 2.0], [2.0, 4.0]]));
        assert!((a - 3.0).abs() < 1e-9 || (b - 1.5).abs() < 1e-9, "{a} {b}");
        assert_eq!(fit(&[]), [LEAST_NS; 2]);
    }

    #[test]
    fn no_cost_is_negative() {
        // More of the second count takes less time.
        let times = [
            ([10.0, 1.0], 100.0),
            ([10.0, 5.0], 80.0),
            ([20.0, 5.0], 190.0),
        ];
        let measured = times.map(|(counts, ns)| Measured { counts, ns });
        assert!(fit(&measured).iter().all(|cost| *cost > 0.0));
    }
}
