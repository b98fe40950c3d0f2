//! Integrals of the GGX lobe for a look-up table in shaders: albedo under uniform light, and mean direction.

use std::{f64::consts::PI, sync::LazyLock};

/// Number of nodes along the square root of the view's cosine, 0 to 1.
pub const LOBE_COSINES: u32 = 24;
/// Number of nodes along perceptual roughness, 0 to 1.
pub const LOBE_ROUGHNESSES: u32 = 16;
/// Number of all nodes.
pub const LOBE_NODES: u32 = LOBE_COSINES * LOBE_ROUGHNESSES;

/// Number of facets that each integral sums, in slope and around the normal.
const STEPS: [u32; 2] = [40, 16];
/// Minimum cosine: at exactly 90 degrees the integrals are not defined.
pub const LEAST_COSINE: f64 = 1e-4;
/// GGX alpha, the square of roughness, below which highlights would be smaller than rounding errors: reflections are
/// treated as sharp.
pub const SMOOTH_ALPHA: f64 = 2e-3;

/// Table nodes in rows of roughness, each by cosine: see `shaders/lib/lobe_albedo.wgsl`.
pub fn lobe_table() -> &'static [[f32; 4]] {
    static TABLE: LazyLock<Vec<[f32; 4]>> = LazyLock::new(|| {
        let nodes = (0..LOBE_ROUGHNESSES).flat_map(|row| (0..LOBE_COSINES).map(move |i| (row, i)));
        let node = |(row, i): (u32, u32)| {
            let place = f64::from(i) / f64::from(LOBE_COSINES - 1);
            let roughness = f64::from(row) / f64::from(LOBE_ROUGHNESSES - 1);
            lobe((place * place).max(LEAST_COSINE), roughness)
        };
        nodes.map(node).collect()
    });
    &TABLE
}

/// Integrals over the facets of a surface, whose slopes follow GGX, with the height-correlated Smith term (Heitz
/// 2014, eq. 99), seen at this cosine: the albedo, the part of it weighted by Schlick's power, and the mean
/// direction of the light along the normal and away from the view, times the albedo.
fn lobe(cosine: f64, roughness: f64) -> [f32; 4] {
    let alpha = (roughness * roughness).max(SMOOTH_ALPHA);
    let a2 = alpha * alpha;
    let sine = (1.0 - cosine * cosine).sqrt();
    let root = |n: f64| (a2 + (1.0 - a2) * n * n).sqrt();
    let mut sums = [0.0; 4];
    for i in 0..STEPS[0] {
        // The square of the slope is a² u / (1 − u). Steps are finer towards the steepest facets, which most of the
        // light at grazing angles meets.
        let rest = 1.0 - (f64::from(i) + 0.5) / f64::from(STEPS[0]);
        let (u, step) = (1.0 - rest.powi(3), 3.0 * rest * rest);
        let up = 1.0 / (1.0 + a2 * u / (1.0 - u)).sqrt();
        let flat = (1.0 - up * up).sqrt();
        for k in 0..STEPS[1] {
            // Half of the circle suffices: the other half is its mirror image.
            let phi = PI * (f64::from(k) + 0.5) / f64::from(STEPS[1]);
            let across = flat * phi.cos();
            let vh = sine * across + cosine * up;
            let nl = 2.0 * vh * up - cosine;
            if vh <= 0.0 || nl <= 0.0 {
                continue;
            }
            let visible = 0.5 / (nl * root(cosine) + cosine * root(nl));
            let light = step * visible * 4.0 * nl * vh / up;
            let away = sine - 2.0 * vh * across;
            let parts = [1.0, (1.0 - vh.min(1.0)).powi(5), nl, away];
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum += light * part;
            }
        }
    }
    sums.map(|sum| (sum / f64::from(STEPS[0] * STEPS[1])) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_lobes_return_everything_from_the_mirrored_direction() {
        for cosine in [0.1_f64, 0.5, 1.0] {
            let [all, schlick, up, away] = lobe(cosine, 0.0).map(f64::from);
            assert!((all - 1.0).abs() < 2e-3, "{all} at {cosine}");
            assert!((schlick - (1.0 - cosine).powi(5)).abs() < 2e-3);
            assert!((up - cosine).abs() < 5e-3, "{up} at {cosine}");
            assert!((away - (1.0 - cosine * cosine).sqrt()).abs() < 5e-3);
        }
    }

    /// At alpha = 1 the normals are spread evenly and both Smith roots are 1: seen from above, the integral of x /
    /// (1 + x) over the cosine x is left.
    #[test]
    fn rough_lobes_lose_light_and_never_gain() {
        let all = lobe_table().iter().map(|node| node[0]);
        assert!(all.clone().all(|share| (0.3..1.003).contains(&share)));
        let last = lobe(1.0, 1.0)[0];
        assert!((last - (1.0 - 2.0_f32.ln())).abs() < 2e-3, "{last}");
    }
}
