//! Radiance beyond the range of 16-bit floats is kept, or clamped where the scene asks for 16 bits.

use std::collections::BTreeSet;

use crate::{closed_form::MIRROR, kit::*};

/// The upper half of the sky, in 64 rows.
const SKY: &str = include_str!("precision/sky.toml");

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

/// A matte floor below a lamp.
const FLOOR: &str = include_str!("precision/floor.toml");

/// Adapters may round all numbers down that lie between two of 16 bits: 0.035 % darker in the mean.
#[test]
fn light_of_16_bits_is_as_bright_as_light_of_32() {
    let Some(gpu) = gpu() else { return };
    let [half, full] = ["half", "full"].map(|bits| {
        let bits = format!("image.radiance={bits}");
        let picture = render(gpu, FLOOR, &[&bits], &[Aov::Radiance]);
        let values = floats(&picture, Aov::Radiance);
        values.iter().map(|v| f64::from(*v)).collect::<Vec<_>>()
    });
    assert_ne!(half, full);
    let shares = (half.iter().zip(&full)).map(|(half, full)| half / full - 1.0);
    let mean = shares.sum::<f64>() / half.len() as f64;
    // Rounded to the nearest, 1,536 gray pixels deviate by 0.00002 / √1536 and the common error of neighbors.
    assert!(mean.abs() < 3e-5, "{mean}");
}
