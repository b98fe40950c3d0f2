//! Light that surfaces let pass on its straight way, in shadows of all kinds of lights.

use crate::common::cases;

use super::kit::*;

/// A matte floor below a pane that is above the camera.
const FLOOR: &str = include_str!("passed/floor.toml");
const PANES: &str = include_str!("passed/panes.txt");
const LIGHTS: &str = include_str!("passed/lights.txt");

/// Mean color of the floor below this pane and light.
fn lit(pane: &str, light: &str, set: &[&str]) -> Option<[f32; 3]> {
    let text = format!("{FLOOR}{pane}\n{light}\n");
    Some(mean(&render(gpu()?, &text, set, &[])))
}

#[test]
fn shadows_have_what_a_straight_ray_through_a_surface_passes() {
    // Each pane is below a map by one method and below a lamp with a size by the other. A cube map differs from a map by
    // its look-up alone, for which a third of the panes is enough: blended, partly transmitting, opaque and doubled panes.
    for (first, (light, kind)) in cases(LIGHTS).into_iter().enumerate() {
        let open = or_skip!(lit(
            "alpha = 1",
            light,
            &["instance.pane.casts_shadow=false"]
        ));
        let is_cube = kind == "cube map";
        let panes = cases(PANES).into_iter().enumerate();
        for (i, (pane, passed)) in panes.filter(|(i, _)| !is_cube || i % 3 == 1) {
            let method = ["rt", "path"][usize::from(!is_cube) * (first + i) % 2];
            let set = format!("reflection.method={method}");
            let found = lit(pane, light, &[&set]).unwrap_or_default();
            for (k, share) in passed.split(' ').enumerate() {
                let share: f32 = share.parse().expect("a number");
                let error = (found[k] / open[k] - share).abs();
                assert!(
                    error < 4e-3,
                    "{kind}, {method}, {pane}: {found:?} of {open:?}"
                );
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
        let [lux, way_m, share] = [0; 3].map(|_| {
            expected
                .next()
                .map_or(0.0, |n| n.parse().expect("a number"))
        });
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
