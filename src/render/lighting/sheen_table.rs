//! Integrals of the sheen lobe for a look-up table in shaders: albedo under uniform light, and mean direction.

use std::{f64::consts::PI, sync::LazyLock};

use super::lobe_table::{LEAST_COSINE, LOBE_COSINES, LOBE_NODES, LOBE_ROUGHNESSES};

/// Minimum alpha of sheens, the square of roughness 0.07; sharper lobes are treated as this one.
pub const LEAST_SHEEN_ALPHA: f32 = 0.0049;

/// Number of directions that each integral sums, in height and around the normal.
const STEPS: [u32; 2] = [64, 48];

/// Table like [`lobe_table`](super::lobe_table::lobe_table), for a sheen of color 1; the second number is a factor
/// on the formula that keeps it from reflecting more light than arrives.
pub fn sheen_table() -> &'static [[f32; 4]] {
    static TABLE: LazyLock<Vec<[f32; 4]>> = LazyLock::new(|| {
        let node = |index: u32| {
            let place = f64::from(index % LOBE_COSINES) / f64::from(LOBE_COSINES - 1);
            let roughness = f64::from(index / LOBE_COSINES) / f64::from(LOBE_ROUGHNESSES - 1);
            energy_conserving(lobe((place * place).max(LEAST_COSINE), roughness))
        };
        (0..LOBE_NODES).map(node).collect()
    });
    &TABLE
}

/// A lobe scaled down to reflect no more light than arrives: at grazing angles the formula of sharp lobes reflects
/// up to three times as much.
fn energy_conserving([all, _, up, away]: [f32; 4]) -> [f32; 4] {
    let scale = 1.0 / all.max(1.0);
    [all * scale, scale, up * scale, away * scale]
}

/// Smith's integral Λ as fitted by Estevez & Kulla 2017, with the constants of KHR_materials_sheen.
fn lambda(cosine: f64, alpha: f64) -> f64 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let [a, b, c, d, e] = [
        (21.5473, 25.3245),
        (3.82987, 3.32435),
        (0.19823, 0.16801),
        (-1.97760, -1.27393),
        (-4.32054, -4.85967),
    ]
    .map(|(smooth, rough): (f64, f64)| smooth + (rough - smooth) * t);
    let fit = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cosine < 0.5 {
        fit(cosine).exp()
    } else {
        (2.0 * fit(0.5) - fit(1.0 - cosine)).exp()
    }
}

/// Density of half vectors at this cosine.
fn density(nh: f64, alpha: f64) -> f64 {
    let sine2 = (1.0 - nh * nh).max(0.0);
    (2.0 + 1.0 / alpha) * sine2.powf(0.5 / alpha) / (2.0 * PI)
}

/// The lobe towards a direction, divided by its color and that density, times the cosine there.
fn masking(nv: f64, nl: f64, alpha: f64) -> f64 {
    1.0 / ((1.0 + lambda(nv, alpha) + lambda(nl, alpha)) * 4.0 * nv)
}

/// Integrals over the directions of incoming light, for a view at this cosine: the albedo, and the mean direction of
/// the light along the normal and away from the view, times the albedo.
fn lobe(cosine: f64, roughness: f64) -> [f32; 4] {
    let alpha = (roughness * roughness).max(LEAST_SHEEN_ALPHA.into());
    let sine = (1.0 - cosine * cosine).sqrt();
    let mut sums = [0.0; 4];
    for i in 0..STEPS[0] {
        // Denser towards the horizon, where sharp lobes are.
        let u = (f64::from(i) + 0.5) / f64::from(STEPS[0]);
        let up = u * u;
        let flat = (1.0 - up * up).sqrt();
        // The solid angle of a step: 2π du' where u' is the height.
        let step = masking(cosine, up, alpha) * 2.0 * PI * 2.0 * u;
        for k in 0..STEPS[1] {
            // Half of the circle suffices: the other half is its mirror image.
            let phi = PI * (f64::from(k) + 0.5) / f64::from(STEPS[1]);
            let across = flat * phi.cos();
            let vl = cosine * up + sine * across;
            let nh = (cosine + up) / (2.0 + 2.0 * vl).sqrt().max(1e-9);
            let light = density(nh.min(1.0), alpha) * step;
            let parts = [1.0, 0.0, up, -across];
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

    /// The albedo by uniform sampling of the hemisphere, with the formulas of the extension.
    fn albedo_by_sampling(cosine: f64, roughness: f64) -> f64 {
        let alpha = roughness * roughness;
        let view = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
        let count = 200_000;
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let sum: f64 = (0..count)
            .map(|i| {
                let up = (f64::from(i) + 0.5) / f64::from(count);
                let flat = (1.0 - up * up).sqrt();
                let turn = golden * f64::from(i);
                let light = [flat * turn.cos(), flat * turn.sin(), up];
                let half = [0, 1, 2].map(|k| view[k] + light[k]);
                let length = half.iter().map(|x| x * x).sum::<f64>().sqrt();
                density(half[2] / length, alpha) * masking(cosine, up, alpha)
            })
            .sum();
        sum * 2.0 * PI / f64::from(count)
    }

    #[test]
    fn directional_albedo_is_that_of_even_sampling() {
        for roughness in [0.2, 0.4, 0.7, 1.0] {
            for cosine in [0.1, 0.3, 0.6, 0.9, 1.0] {
                let [albedo, ..] = lobe(cosine, roughness).map(f64::from);
                let expected = albedo_by_sampling(cosine, roughness);
                let error = (albedo - expected).abs();
                assert!(
                    error < 2e-3,
                    "{albedo}, expected {expected} at {cosine}, {roughness}"
                );
            }
        }
    }

    #[test]
    fn sheen_returns_no_more_than_arrives() {
        let all = sheen_table().iter().map(|node| node[0]);
        assert!(all.clone().all(|share| (0.0..=1.0).contains(&share)));
        assert!(lobe(0.01, 0.1)[0] > 1.5, "where the formula alone does");
    }
}
