//! Radiance beyond the range of 16-bit floats is kept, or clamped where the scene asks for 16 bits.

use std::collections::BTreeSet;

use reflet::render::aov::Aov;

use crate::{
    closed_form::MIRROR,
    kit::{assert_color, color, floats, gpu, render},
};

/// The upper half of the sky, in 64 rows.
const SKY: &str = r#"
version = 1
[camera.main]
eye = [0, 0, 0]
target = [0, 1, -1]
fov_deg = 80
[image]
size = [16, 64]
tone_map = "none"
exposure_ev = 20
[material.any]
[model.any]
shape = { kind = "box" }
material = "any"
[[instance]]
model = "any"
translation = [0, -100, 0]
[environment]
zenith = [1e-6, 1e-6, 1e-6]
horizon = [1e-7, 1e-7, 1e-7]
"#;

#[test]
fn what_shines_a_million_times_brighter_than_white_is_as_bright_in_the_picture() {
    let Some(gpu) = gpu() else { return };
    let text = MIRROR.replace("[0.2, 0.5, 0.8]", "[1e6, 5e5, 2]");
    for method in ["ssr", "hybrid", "rt"] {
        let method = format!("reflection.method={method}");
        let seen = ["camera.main.target=[0.3, 0.2, 5]", &method];
        let picture = render(gpu, &text, &seen, &[Aov::Emission, Aov::Radiance]);
        let values = color(&picture, 16, 8);
        for (found, want) in values.into_iter().zip([1e6, 5e5, 2.0]) {
            assert!((found / want - 1.0).abs() < 1e-3, "{method}: {values:?}");
        }
        for aov in [Aov::Emission, Aov::Radiance] {
            assert!(
                (floats(&picture, aov)[0] / 1e6 - 1.0).abs() < 1e-3,
                "{aov:?}"
            );
        }
    }
    for method in ["hybrid", "rt"] {
        let method = format!("reflection.method={method}");
        let picture = render(gpu, &text, &[&method], &[]);
        let values = color(&picture, 16, 8);
        assert!((values[0] / 1e6 - 1.0).abs() < 1e-3, "{method}: {values:?}");
        let cut = render(gpu, &text, &[&method, "image.radiance=half"], &[]);
        assert_color(&cut, 16, 8, [65_000.0, 65_000.0, 2.0], 100.0);
    }
}

#[test]
fn a_gradient_in_the_dark_keeps_its_steps() {
    let Some(gpu) = gpu() else { return };
    let steps = |set: &[&str]| {
        let picture = render(gpu, SKY, set, &[]);
        let rows = (0..64).map(|y| color(&picture, 8, y)[0].to_bits());
        rows.collect::<BTreeSet<_>>().len()
    };
    let (kept, coarse) = (steps(&[]), steps(&["image.radiance=half"]));
    assert!(kept > 50 && coarse < 20, "{kept} and {coarse} of 64 rows");
}
