//! Patterns of two colors: both are visible from near, and from afar one sample equals the mean of many.

use crate::kit::*;

const WALL: &str = include_str!("pattern/wall.toml");

fn scene(kind: &str) -> String {
    WALL.replace("kind = \"brick\"", &format!("kind = \"{kind}\""))
}

/// Share of blue, from 0 in the first color to 1 in the second.
fn share(rgb: [f32; 3]) -> f32 {
    (rgb[2] / (rgb[0] + rgb[1] + rgb[2]) - 0.1 / 1.1) / (0.9 / 1.1 - 0.1 / 1.1)
}

#[test]
fn both_colors_are_seen_from_near() {
    let Some(gpu) = gpu() else { return };
    for (kind, least, most) in [
        ("checker", 0.35, 0.65),
        ("brick", 0.1, 0.45),
        ("noise", 0.3, 0.7),
        ("marble", 0.35, 0.65),
    ] {
        let picture = render(gpu, &scene(kind), &[], &[]);
        let all = (0..64).flat_map(|y| (0..96).map(move |x| (x, y)));
        let shares: Vec<f32> = all.map(|(x, y)| share(color(&picture, x, y))).collect();
        let seen = |low: f32, high: f32| shares.iter().filter(|s| (low..high).contains(*s)).count();
        let (first, second) = (seen(-0.1, 0.3), seen(0.7, 1.1));
        assert!(first > 300 && second > 100, "{kind}: {first} {second}");
        let mean = share(mean(&picture));
        assert!((least..most).contains(&mean), "{kind}: {mean}");
    }
}

/// One sample per pixel against 16: detail finer than a pixel shows its mean, so nothing sparkles.
#[test]
fn patterns_are_filtered() {
    let Some(gpu) = gpu() else { return };
    for kind in ["checker", "brick", "noise", "marble"] {
        for distance in [12, 160] {
            let eye = format!("camera.main.eye=[0.1, 20, {distance}]");
            let one = render(gpu, &scene(kind), &[&eye], &[]);
            let many = render(gpu, &scene(kind), &[&eye, "image.samples=16"], &[]);
            let mut square = 0.0;
            for (x, y) in (0..64).flat_map(|y| (0..96).map(move |x| (x, y))) {
                let difference = share(color(&one, x, y)) - share(color(&many, x, y));
                square += f64::from(difference * difference);
            }
            let error = (square / (96.0 * 64.0)).sqrt();
            assert!(error < 0.12, "{kind} at {distance} m: {error}");
        }
    }
}
