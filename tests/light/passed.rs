//! Light that surfaces let pass on its straight way, in shadows of all kinds of lights.

use crate::common::cases;

use super::kit::*;

/// A matte floor just above which the camera looks down, below panes.
const FLOOR: &str = include_str!("passed/floor.toml");
const PANES: &str = include_str!("passed/panes.txt");
const LIGHTS: &str = include_str!("passed/lights.txt");

const PANE: &str = include_str!("passed/pane.toml");

/// Mean colors of the floor below the middle of each of up to 16 panes of 8 × 8 pixels beside each other.
fn lit(gpu: &Gpu, panes: &[(&str, &str)], light: &str, set: &str, casts: &str) -> Vec<Vec3> {
    let mut text = format!("{FLOOR}{light}\n");
    for (i, (keys, _)) in panes.iter().enumerate() {
        let [x, z] = [i % 4, i / 4].map(|k| (0.4 * k as f32 - 0.6).to_string());
        let pane = PANE.replace("KEYS", keys).replace("INDEX", &i.to_string());
        text += &pane
            .replace("LEFT", &x)
            .replace("DOWN", &z)
            .replace("CASTS", casts);
    }
    let picture = render(gpu, &text, &[set], &[]);
    let middle = |i| {
        let pixels = (0..16).map(|k| [i % 4 * 8 + 2 + k % 4, i / 4 * 8 + 2 + k / 4]);
        pixels
            .map(|[x, y]| Vec3::from(color(&picture, x, y)))
            .sum::<Vec3>()
            / 16.0
    };
    (0..panes.len() as u32).map(middle).collect()
}

#[test]
fn shadows_have_what_a_straight_ray_through_a_surface_passes() {
    let Some(gpu) = gpu() else { return };
    // Some without cut-outs, by shaders that know of none. A cube map differs from a map by its look-up alone.
    let panes = cases(PANES);
    let is_whole = |(keys, _): &&(&str, &str)| !keys.contains("cutoff");
    let whole: Vec<_> = panes.iter().filter(is_whole).copied().collect();
    for (i, &(light, methods)) in first_or_all(&cases(LIGHTS), 2).iter().enumerate() {
        // The first light is seen by all methods, each other light daily by its first method.
        let methods: Vec<_> = methods.split(' ').collect();
        for &method in first_or_all(&methods, if i == 0 { methods.len() } else { 1 }) {
            let panes = if method == "path" { &whole } else { &panes };
            let set = format!("reflection.method={method}");
            let [open, found] = ["false", "true"].map(|casts| lit(gpu, panes, light, &set, casts));
            for ((pane, passed), (open, found)) in panes.iter().zip(open.iter().zip(found)) {
                let passed: Vec<f32> = passed.split(' ').flat_map(str::parse).collect();
                let error = (found / open - Vec3::from_slice(&passed))
                    .abs()
                    .max_element();
                assert!(error < 4e-3, "{light}, {method}, {pane}: {found} of {open}");
            }
        }
    }
}

/// A floor within a solid that absorbs, below a pane that is within it too.
const WITHIN: &str = include_str!("passed/within.toml");
const WAYS: &str = include_str!("passed/within.txt");

#[test]
fn solids_absorb_light_on_its_way_to_what_is_within_them() {
    let Some(gpu) = gpu() else { return };
    for (settings, expected) in cases(WAYS) {
        let mut expected = expected.split(' ');
        let numbers: Vec<f32> = expected.by_ref().take(3).flat_map(str::parse).collect();
        let [lux, way_m, share] = numbers[..] else {
            panic!("{numbers:?}")
        };
        for method in expected {
            let method = format!("reflection.method={method}");
            let set: Vec<&str> = settings.lines().chain([&*method]).collect();
            for (found, kept) in mean(&render(gpu, WITHIN, &set, &[]))
                .iter()
                .zip([1.0, 0.5, 0.25_f32])
            {
                let radiance = lux / std::f32::consts::PI * share * kept.powf(way_m);
                assert!(
                    (found - radiance).abs() < 0.01 * radiance + 1e-6,
                    "{set:?}: {found}, expected {radiance}"
                );
            }
        }
    }
}
