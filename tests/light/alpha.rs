//! Pictures with a transparent background.

use super::kit::*;

/// A white matte ball in the middle of a bright world.
const BALL: &str = include_str!("alpha/ball.toml");

#[test]
fn alpha_is_the_share_of_a_pixel_that_shows_something() {
    let Some(gpu) = gpu() else { return };
    let picture = render(gpu, BALL, &[], &[]);
    assert!(picture.alpha);
    let mut sum = 0.0;
    for (linear, shown) in picture
        .color
        .chunks_exact(4)
        .zip(picture.display.chunks_exact(4))
    {
        let alpha = linear[3];
        sum += alpha;
        // Radiance is multiplied by alpha, display color is not.
        assert!((linear[0] - 0.5 * alpha).abs() < 2e-3, "{linear:?}");
        assert!(
            (f32::from(shown[3]) - 255.0 * alpha).abs() <= 0.51,
            "{shown:?}"
        );
        assert!(shown[3] == 0 || shown[0].abs_diff(188) <= 1, "{shown:?}");
    }
    // The outline of a ball of radius 1 seen from 4 m: tan of its half angle over tan of the view's.
    let radius_px = 16.0 / 15_f32.sqrt() / 20_f32.to_radians().tan();
    assert_close(sum, PI * radius_px * radius_px, 0.01);
    let opaque = render(gpu, BALL, &["image.alpha=false"], &[]);
    assert!(!opaque.alpha && opaque.color.chunks_exact(4).all(|c| c[3] == 1.0));
}

#[test]
fn blended_surfaces_cover_by_their_alpha_and_glass_wholly() {
    let Some(gpu) = gpu() else { return };
    for (blended, expected) in [(true, 1.0 - 0.7 * 0.7), (false, 1.0)] {
        let (desc, mut world) = scene(BALL, &["material.white.transmission=1"]);
        let material = &mut world.materials[0];
        if blended {
            material.transmission = None;
            material.blended = true;
            material.base_color.w = 0.3;
        }
        let mut renderer = renderer(gpu, &desc, &world, false);
        let picture = renderer.first_view(&world, &[]);
        let alpha = |x: usize, y: usize| picture.color[4 * (y * 32 + x) + 3];
        let middle: f32 = (12..20)
            .flat_map(|y| (12..20).map(move |x| alpha(x, y)))
            .sum();
        assert_close(middle / 64.0, expected, 0.02);
        assert_eq!(alpha(0, 0), 0.0);
    }
}

#[test]
fn an_environment_that_is_not_shown_is_not_shown_through_what_is_blended() {
    let Some(gpu) = gpu() else { return };
    let cases = [
        ("hybrid", "visible=false", [0.0; 3]),
        ("path", "background=[0.1, 0.2, 0.3]", [0.1, 0.2, 0.3]),
        ("path", "visible=false", [0.0; 3]),
        ("hybrid", "background=[0.1, 0.2, 0.3]", [0.1, 0.2, 0.3]),
    ];
    for &(method, shown, expected) in first_or_all(&cases, 2) {
        let method = format!("reflection.method={method}");
        let shown = format!("environment.{shown}");
        let set = [
            &shown,
            "image.alpha=false",
            "material.white.alpha=0",
            &method,
        ];
        let picture = render(gpu, BALL, &set, &[]);
        for pixel in 0..32 {
            assert_color(&picture, pixel, pixel / 2, expected, 1e-3);
        }
    }
}
