//! Light that fog scatters, beside its integral.

use std::f64::consts::PI;

use glam::DVec3;

use super::kit::*;

/// Extinction of the fog, 1 / m.
const DENSITY: f64 = 0.15;

/// Radiance 1 of a box of 1.2 × 0.5 × 0.1 m around (0, 0.6, -1.4) that reaches a point through the fog, over all
/// directions.
fn arriving(at: DVec3) -> f64 {
    let (low, high) = (DVec3::new(-0.6, 0.35, -1.45), DVec3::new(0.6, 0.85, -1.35));
    let size = high - low;
    let steps = 24;
    let places = |k: u32| [k % steps, k / steps].map(|i| (f64::from(i) + 0.5) / f64::from(steps));
    let mut sum = 0.0;
    for (axis, side) in (0..3).flat_map(|axis| [(axis, low), (axis, high)]) {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let out = if side == low { -1.0 } else { 1.0 };
        let area = size[u] * size[v] / f64::from(steps * steps);
        for [a, b] in (0..steps * steps).map(places) {
            let mut place = side;
            place[u] = low[u] + a * size[u];
            place[v] = low[v] + b * size[v];
            let way = place - at;
            let cosine = -way[axis] * out / way.length();
            sum += cosine.max(0.0) * area / way.length_squared() * (-DENSITY * way.length()).exp();
        }
    }
    sum
}

/// Single scattering of the box's light into a ray, by the midpoint rule.
fn scattered(from: DVec3, to: DVec3) -> f64 {
    let length_m = from.distance(to);
    let steps = 100;
    let parts = (0..steps).map(|k| {
        let share = (f64::from(k) + 0.5) / f64::from(steps);
        (-DENSITY * share * length_m).exp() * arriving(from.lerp(to, share))
    });
    parts.sum::<f64>() * length_m / f64::from(steps) * DENSITY / (4.0 * PI)
}

/// Points of the ray and of the emitter are sampled in two ways, whose shares sum to 1.
#[test]
fn fog_scatters_as_much_of_an_emitter_as_its_integral() {
    let Some(gpu) = gpu() else { return };
    let eye = DVec3::new(0.0, 2.5, 0.2);
    for (target, within) in [
        (DVec3::new(-0.3, 0.0, 0.3), 2e-3),
        (DVec3::new(0.1, 0.0, -0.9), 4e-3),
    ] {
        let text = include_str!("fog_closed_form.toml")
            .replace("TARGET_X", &target.x.to_string())
            .replace("TARGET_Z", &target.z.to_string());
        let found = f64::from(mean(&render(gpu, &text, &[], &[]))[1]) / 4.0;
        let off = found / scattered(eye, target) - 1.0;
        assert!(off.abs() < within, "{off} towards {target}");
    }
}

/// Nothing but even surroundings before a camera within, above or deep in the layer, which looks up or down: of their
/// light passes what the depth to infinity leaves, and the rest is scattered by the albedo 0, 1/2 and 1.
#[test]
fn empty_surroundings_are_seen_from_within_fog() {
    let Some(gpu) = gpu() else { return };
    for (density, eye_m, up_deg) in [
        (0.2, 0.2, 30.0),
        (0.2, 0.2, 60.0),
        (0.2, 3.0, 10.0),
        (0.2, 0.2, -10.0),
        (50.0, 0.2, 30.0),
    ] {
        let (rise, ahead) = f64::to_radians(up_deg).sin_cos();
        let text = format!(
            "version = 1\n[camera.main]\neye = [0, {eye_m}, 0]\ntarget = [0, {}, {}]\n\
             orthographic_height_m = 0.001\n[image]\nsize = [8, 8]\ntone_map = \"none\"\nradiance = \"full\"\n\
             [reflection]\nmethod = \"rt\"\n[environment]\ncolor = [1, 1, 1]\nfog = {{ density = {density}, \
             height_m = 1, falloff_m = 1.5, color = [0, 0.5, 1], anisotropy = 0.4 }}\n",
            eye_m + rise,
            -ahead
        );
        let picture = render(gpu, &text, &[], &[]);
        let thinness = (-f64::max(eye_m - 1.0, 0.0) / 1.5).exp();
        let above_m = f64::max(1.0 - eye_m, 0.0) + 1.5 * thinness;
        let depth = if rise > 0.0 {
            density * above_m / rise
        } else {
            f64::INFINITY
        };
        let passed = (-depth).exp() as f32;
        let expected = [passed, 0.5 + 0.5 * passed, 1.0];
        for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
            assert_color(&picture, x, y, expected, 2e-4);
        }
    }
}
