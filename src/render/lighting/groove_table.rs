//! Albedo of anisotropic GGX lobes relative to isotropic ones, for a look-up table in shaders.

use std::{f64::consts::PI, sync::LazyLock};

use super::lobe_table::{LEAST_COSINE, SMOOTH_ALPHA};

/// Number of nodes along the square root of the view's cosine, 0 to 1.
pub const GROOVE_COSINES: u32 = 8;
/// Number of nodes along perceptual roughness, and along the strength of the anisotropy, 0 to 1.
pub const GROOVE_STEPS: u32 = 6;
/// Number of all nodes.
pub const GROOVE_NODES: u32 = GROOVE_COSINES * GROOVE_STEPS * GROOVE_STEPS;

/// Number of facets that each integral sums, in slope and around the normal.
const STEPS: [u32; 2] = [24, 24];

/// Table nodes by anisotropy, then roughness, then cosine: the albedo under uniform light of a white lobe over the
/// albedo of the isotropic lobe with the same mean of alpha², as factors of cos 2nφ, where φ is the view's angle to the
/// grooves.
pub fn groove_table() -> &'static [[f32; 4]] {
    static TABLE: LazyLock<Vec<[f32; 4]>> = LazyLock::new(|| {
        let share = |i: u32, count: u32| f64::from(i) / f64::from(count - 1);
        let node = |index: u32| {
            let place = share(index % GROOVE_COSINES, GROOVE_COSINES);
            let row = index / GROOVE_COSINES;
            let roughness = share(row % GROOVE_STEPS, GROOVE_STEPS);
            let strength = share(row / GROOVE_STEPS, GROOVE_STEPS);
            node((place * place).max(LEAST_COSINE), roughness, strength)
        };
        (0..GROOVE_NODES).map(node).collect()
    });
    &TABLE
}

/// GGX alphas along the grooves and across them (KHR_materials_anisotropy).
fn alphas(roughness: f64, strength: f64) -> [f64; 2] {
    let across = (roughness * roughness).max(SMOOTH_ALPHA);
    [across + (1.0 - across) * strength * strength, across]
}

fn node(cosine: f64, roughness: f64, strength: f64) -> [f32; 4] {
    let [along, across] = alphas(roughness, strength);
    let mean = (0.5 * (along * along + across * across)).sqrt();
    let isotropic = albedo(cosine, 0.0, [mean; 2]);
    let [a, b, c, d] =
        [0.0, 1.0, 2.0, 3.0].map(|k| albedo(cosine, k * PI / 6.0, [along, across]) / isotropic);
    // Discrete cosine transform of four nodes over a half-turn of 2φ.
    let factors = [
        (a + 2.0 * b + 2.0 * c + d) / 6.0,
        (a + b - c - d) / 3.0,
        (a - b - c + d) / 3.0,
        (a - 2.0 * b + 2.0 * c - d) / 6.0,
    ];
    factors.map(|factor| factor as f32)
}

/// Albedo of a lobe with these alphas, with the height-correlated Smith term (Heitz 2014, eq. 99), seen at this cosine
/// and angle around the normal. Steps over facets are the same as in `lobe_table`, around the whole circle.
fn albedo(cosine: f64, turn: f64, [along, across]: [f64; 2]) -> f64 {
    let sine = (1.0 - cosine * cosine).sqrt();
    let view = [sine * turn.cos(), sine * turn.sin()];
    let masked = |x: f64, y: f64, z: f64| (along * x).hypot(across * y).hypot(z);
    let mut sum = 0.0;
    for i in 0..STEPS[0] {
        let rest = 1.0 - (f64::from(i) + 0.5) / f64::from(STEPS[0]);
        let (u, step) = (1.0 - rest.powi(3), 3.0 * rest * rest);
        let slope = (u / (1.0 - u)).sqrt();
        for k in 0..STEPS[1] {
            let phi = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(STEPS[1]);
            let (x, y) = (along * slope * phi.cos(), across * slope * phi.sin());
            let up = 1.0 / (1.0 + x * x + y * y).sqrt();
            let (x, y) = (x * up, y * up);
            let vh = view[0] * x + view[1] * y + cosine * up;
            let nl = 2.0 * vh * up - cosine;
            if vh <= 0.0 || nl <= 0.0 {
                continue;
            }
            let [out_x, out_y] = [2.0 * vh * x - view[0], 2.0 * vh * y - view[1]];
            let both = nl * masked(view[0], view[1], cosine) + cosine * masked(out_x, out_y, nl);
            sum += step * 0.5 / both * 4.0 * nl * vh / up;
        }
    }
    sum / f64::from(STEPS[0] * STEPS[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting::lobe_table::lobe_table;

    #[test]
    fn without_anisotropy_the_albedo_is_that_of_the_isotropic_lobe() {
        for node in &groove_table()[..(GROOVE_COSINES * GROOVE_STEPS) as usize] {
            assert!(
                (node[0] - 1.0).abs() < 1e-4 && node[1..].iter().all(|v| v.abs() < 1e-4),
                "{node:?}"
            );
        }
        // The roughest row and the steepest view of both tables.
        let last = lobe_table()[lobe_table().len() - 1][0];
        let own = albedo(1.0, 1.0, [1.0; 2]) as f32;
        assert!((own - last).abs() < 2e-3, "{own}, expected {last}");
    }

    /// Integrals over 300 × 200 facets, by the view's angle to the direction in which facets tilt most.
    #[test]
    fn few_steps_find_the_integral() {
        for (cosine, expected) in [
            (0.3, [0.7781, 0.7400, 0.6143]),
            (0.6, [0.6919, 0.6674, 0.6289]),
        ] {
            for (k, expected) in (0..3).zip(expected) {
                let found = albedo(cosine, f64::from(k) * PI / 4.0, [0.8, 0.1]);
                assert!(
                    (found - expected).abs() < 2e-3,
                    "{found}, expected {expected}"
                );
            }
        }
    }
}
