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

/// One sample per pixel against 16: detail finer than a pixel shows its mean, so nothing sparkles. The blur of one sample
/// is wider, so that it differs from 16 in contrast, but has no more of it.
#[test]
fn patterns_are_filtered() {
    let Some(gpu) = gpu() else { return };
    for kind in ["checker", "brick", "noise", "marble"] {
        for distance in [12, 160] {
            let eye = format!("camera.main.eye=[0.1, 20, {distance}]");
            let one = render(gpu, &scene(kind), &[&eye], &[]);
            let many = render(gpu, &scene(kind), &[&eye, "image.samples=16"], &[]);
            let pixels = || (0..64).flat_map(|y| (0..96).map(move |x| (x, y)));
            let of = |picture, x, y| f64::from(share(color(picture, x, y)));
            let rms = |of: &dyn Fn(u32, u32) -> f64| {
                let square: f64 = pixels().map(|(x, y)| of(x, y).powi(2)).sum();
                (square / (96.0 * 64.0)).sqrt()
            };
            let error = rms(&|x, y| of(&one, x, y) - of(&many, x, y));
            assert!(error < 0.18, "{kind} at {distance} m: {error}");
            let [less, more] = [&one, &many].map(|picture| rms(&|x, y| of(picture, x, y) - 0.5));
            assert!(
                less < 1.02 * more,
                "{kind} at {distance} m: {less} against {more}"
            );
        }
    }
}
