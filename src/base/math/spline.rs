//! Curves through points, their length, and easing, for camera paths.

use std::ops::{Add, Mul};

use glam::DVec3;

/// Uniform Catmull-Rom (Catmull & Rom, "A class of local interpolating splines", 1974): from `p[1]`
/// at `u` = 0 to `p[2]` at 1, with the tangent (next − previous) / 2 at each where the `times` from
/// point to point are equal. Where they differ, the tangent is scaled for each side's time, so that the
/// velocity is continuous (Kochanek & Bartels, "Interpolating splines with local tension, continuity,
/// and bias control", 1984, "Adjustments for parametrization").
pub fn catmull_rom(p: [DVec3; 4], times: [f64; 3], u: f64) -> DVec3 {
    let out = (p[2] - p[0]) * (times[1] / (times[0] + times[1]));
    let into = (p[3] - p[1]) * (times[1] / (times[1] + times[2]));
    hermite(p[1], out, p[2], into, u)
}

/// Centripetal Catmull-Rom from `p[1]` to `p[2]`, which has no cusps or loops (Yuksel, Schaefer,
/// Keyser, "Parameterization and applications of Catmull-Rom curves", 2011; knots at the square
/// roots of distances). Points that coincide give no knot interval and count as one.
pub fn centripetal(p: [DVec3; 4], u: f64) -> DVec3 {
    let interval = |a: DVec3, b: DVec3| a.distance(b).sqrt();
    let [before, here, after] = [
        interval(p[0], p[1]),
        interval(p[1], p[2]),
        interval(p[2], p[3]),
    ];
    if here == 0.0 {
        return p[1];
    }
    // Tangents of the non-uniform curve, over the middle interval.
    let tangent = |from: DVec3, at: DVec3, to: DVec3, d1: f64, d2: f64| {
        if d1 == 0.0 || d2 == 0.0 {
            return (to - from) * (here / (d1 + d2));
        }
        ((at - from) / d1 - (to - from) / (d1 + d2) + (to - at) / d2) * here
    };
    let out = tangent(p[0], p[1], p[2], before, here);
    let into = tangent(p[1], p[2], p[3], here, after);
    hermite(p[1], out, p[2], into, u)
}

/// Cubic Hermite curve from `a` with tangent `out` to `b` with tangent `into`.
pub fn hermite<V>(a: V, out: V, b: V, into: V, u: f64) -> V
where
    V: Add<Output = V> + Mul<f64, Output = V>,
{
    let (u2, u3) = (u * u, u * u * u);
    a * (2.0 * u3 - 3.0 * u2 + 1.0)
        + out * (u3 - 2.0 * u2 + u)
        + b * (3.0 * u2 - 2.0 * u3)
        + into * (u3 - u2)
}

/// Cubic Bézier curve with these control points.
pub fn bezier(p: [DVec3; 4], u: f64) -> DVec3 {
    let v = 1.0 - u;
    p[0] * (v * v * v) + p[1] * (3.0 * v * v * u) + p[2] * (3.0 * v * u * u) + p[3] * (u * u * u)
}

/// Easing that starts slowly: u².
pub fn ease_in(u: f64) -> f64 {
    u * u
}

/// Easing that ends slowly: 2u − u².
pub fn ease_out(u: f64) -> f64 {
    u * (2.0 - u)
}

/// Easing that starts and ends slowly: the smooth step 3u² − 2u³.
pub fn ease_in_out(u: f64) -> f64 {
    u * u * (3.0 - 2.0 * u)
}

/// Table of lengths along a curve, to move on it at constant speed.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcLength {
    /// Length from the start to each of the evenly spaced parameters.
    lengths: Vec<f64>,
}

impl ArcLength {
    /// Measures `curve`, whose parameter runs from 0 to 1, with `steps` chords.
    pub fn measure(steps: usize, curve: impl Fn(f64) -> DVec3) -> Self {
        let steps = steps.max(1);
        let mut lengths = vec![0.0];
        let (mut length, mut last) = (0.0, curve(0.0));
        for i in 1..=steps {
            let next = curve(i as f64 / steps as f64);
            length += last.distance(next);
            last = next;
            lengths.push(length);
        }
        Self { lengths }
    }

    /// Length of the whole curve.
    pub fn total(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// The curve's parameter, 0 to 1, at which `share` (0 to 1) of its length is passed; `share` itself where the
    /// curve has no length.
    pub fn parameter(&self, share: f64) -> f64 {
        let (total, steps) = (self.total(), self.lengths.len() - 1);
        if total <= 0.0 {
            return share;
        }
        let wanted = share.clamp(0.0, 1.0) * total;
        let after = self
            .lengths
            .partition_point(|l| *l < wanted)
            .clamp(1, steps);
        let (a, b) = (self.lengths[after - 1], self.lengths[after]);
        let within = if b > a { (wanted - a) / (b - a) } else { 0.0 };
        (after as f64 - 1.0 + within) / steps as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: [DVec3; 4] = [
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(1.0, 2.0, 0.0),
        DVec3::new(4.0, 2.5, 1.0),
        DVec3::new(4.5, -1.0, 3.0),
    ];

    #[test]
    fn curves_pass_through_their_points() {
        let uniform = |p, u| catmull_rom(p, [1.0, 2.0, 0.5], u);
        for curve in [uniform, centripetal] {
            assert!(curve(P, 0.0).distance(P[1]) < 1e-12);
            assert!(curve(P, 1.0).distance(P[2]) < 1e-12);
        }
        assert_eq!(bezier(P, 0.0), P[0]);
        assert_eq!(bezier(P, 1.0), P[3]);
        // De Casteljau's construction at one half: (a + 3b + 3c + d) / 8.
        let half = (P[0] + 3.0 * P[1] + 3.0 * P[2] + P[3]) / 8.0;
        assert!(bezier(P, 0.5).distance(half) < 1e-12);
    }

    /// The pyramid algorithm of Barry and Goldman, an independent way to evaluate the same curve.
    fn barry_goldman(p: [DVec3; 4], alpha: f64, u: f64) -> DVec3 {
        let mut t = [0.0; 4];
        for i in 1..4 {
            t[i] = t[i - 1] + p[i].distance(p[i - 1]).powf(alpha);
        }
        let x = t[1] + u * (t[2] - t[1]);
        let mix = |a: DVec3, b: DVec3, ta: f64, tb: f64| {
            a * ((tb - x) / (tb - ta)) + b * ((x - ta) / (tb - ta))
        };
        let a: Vec<_> = (0..3)
            .map(|i| mix(p[i], p[i + 1], t[i], t[i + 1]))
            .collect();
        let b: Vec<_> = (0..2)
            .map(|i| mix(a[i], a[i + 1], t[i], t[i + 2]))
            .collect();
        mix(b[0], b[1], t[1], t[2])
    }

    #[test]
    fn both_catmull_rom_curves_equal_their_pyramids() {
        for i in 0..=20 {
            let u = f64::from(i) / 20.0;
            assert!(centripetal(P, u).distance(barry_goldman(P, 0.5, u)) < 1e-12);
            assert!(catmull_rom(P, [1.0; 3], u).distance(barry_goldman(P, 0.0, u)) < 1e-12);
        }
    }

    #[test]
    fn coinciding_points_stay_finite() {
        for p in [
            [P[0], P[0], P[1], P[2]],
            [P[0], P[1], P[1], P[2]],
            [P[0], P[1], P[2], P[2]],
            [P[0]; 4],
        ] {
            for u in [0.0, 0.3, 1.0] {
                assert!(centripetal(p, u).is_finite(), "{p:?} {u}");
            }
            assert!(centripetal(p, 0.0).distance(p[1]) < 1e-12);
            assert!(centripetal(p, 1.0).distance(p[2]) < 1e-12);
        }
    }

    #[test]
    fn arc_length_makes_speed_constant() {
        let curve = |u: f64| bezier(P, u * u); // far from constant by itself
        let arc = ArcLength::measure(4096, curve);
        let points: Vec<_> = (0..=50)
            .map(|i| curve(arc.parameter(f64::from(i) / 50.0)))
            .collect();
        let steps: Vec<_> = points.windows(2).map(|p| p[0].distance(p[1])).collect();
        let mean = steps.iter().sum::<f64>() / 50.0;
        for step in steps {
            assert!((step / mean - 1.0).abs() < 0.01, "{step} {mean}");
        }
        let circle = ArcLength::measure(4096, |u| {
            let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
            DVec3::new(cos, 0.0, sin)
        });
        assert!((circle.total() - std::f64::consts::TAU).abs() < 1e-5);
        assert_eq!(ArcLength::measure(8, |_| P[0]).parameter(0.3), 0.3);
    }
}
