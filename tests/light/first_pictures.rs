//! First pictures: several paths of one sample find what is behind glass, and light between surfaces is smoothed.

use crate::kit::*;

/// A ball of rough glass in a room that glows, before dark slats.
const SCENE: &str = include_str!("first_pictures/scene.toml");

/// A pixel of rough glass shows light or a slat by one path; one sample follows four, so that errors are half as large:
/// 0.23 in place of 0.45.
#[test]
fn one_sample_follows_four_paths_through_glass() {
    let Some(gpu) = gpu() else { return };
    let of = |samples: u32| {
        let set = ["reflection.method=rt", &format!("image.samples={samples}")];
        render(gpu, SCENE, &set, &[])
    };
    let (first, converged) = (of(1), of(256));
    let middle = (4..14).flat_map(|y| (12..20).map(move |x| (x, y)));
    let squares =
        middle.map(|(x, y)| (color(&first, x, y)[1] - color(&converged, x, y)[1]).powi(2));
    let error = (squares.sum::<f32>() / 80.0).sqrt();
    assert!((0.1..0.3).contains(&error), "{error}");
}

/// A checkered floor of two boxes, one higher than the other, in a room that a lamp lights by way of the ceiling alone.
const ROOM: &str = include_str!("first_pictures/room.toml");

fn room(gpu: &Gpu, samples: u32, set: &[&str]) -> Picture {
    let samples = format!("image.samples={samples}");
    render(gpu, ROOM, &[&[&*samples], set].concat(), &[Aov::BaseColor])
}

fn sum_over_room(of: &dyn Fn(u32, u32) -> f32) -> f32 {
    let pixels = (0..27).flat_map(|y| (0..48).map(move |x| (x, y)));
    pixels.map(|(x, y)| of(x, y)).sum()
}

/// Relative squared error.
fn error(picture: &Picture, converged: &Picture) -> f32 {
    sum_over_room(&|x, y| {
        let (a, b) = (color(picture, x, y)[1], color(converged, x, y)[1]);
        (a - b).powi(2) / (b * b + 0.01)
    })
}

/// Indirect light that rare paths of a pixel find is averaged with its surroundings, but neither across edges nor over
/// textures.
#[test]
fn light_between_surfaces_is_smooth_in_first_pictures() {
    let Some(gpu) = gpu() else { return };
    let plain = ["reflection.filter=false"];
    let (grainy, smooth) = (room(gpu, 1, &plain), room(gpu, 1, &[]));
    let converged = room(gpu, 128, &[]);
    let light = |picture| sum_over_room(&|x, y| color(picture, x, y)[1]);
    let bases = floats(&smooth, Aov::BaseColor);
    let red_of_cyan = sum_over_room(&|x, y| match bases[3 * (y * 48 + x) as usize] < 1e-3 {
        true => color(&smooth, x, y)[0],
        false => 0.0,
    });
    let errors = error(&smooth, &converged) / error(&grainy, &converged);
    assert!(errors < 0.08, "{errors}");
    let kept = light(&smooth) / light(&grainy);
    assert!((kept - 1.0).abs() < 0.03, "{kept}");
    assert!(red_of_cyan < 0.01, "{red_of_cyan}");
}

/// Smoothing fades out without a step where pictures stop to have few samples (16, and 33 for facets): neither matte surfaces nor rough metal show more error with more samples.
#[test]
fn error_falls_with_the_number_of_samples() {
    let Some(gpu) = gpu() else { return };
    let metal = ["material.floor.metallic=1", "material.floor.roughness=0.4"];
    let plain = ["reflection.filter=false"];
    for set in first_or_all(&[&metal[..], &[]], 1) {
        let converged = room(gpu, 96, set);
        let counts = match is_long() {
            true => &[1, 4, 8, 15, 16, 32, 40][..],
            false => &[1, 15, 16, 40],
        };
        let errors = counts
            .iter()
            .map(|n| error(&room(gpu, *n, set), &converged));
        let errors: Vec<f32> = errors.collect();
        let falls = errors.windows(2).all(|pair| pair[1] < 1.05 * pair[0]);
        assert!(falls, "{set:?}: {errors:?}");
    }
    // Without light between matte surfaces only rough reflections are left to smooth, and mirrors have none.
    let mirror = [metal[0], "material.floor.reflection=mirror", NO_BOUNCES];
    let metal = [metal[0], metal[1], NO_BOUNCES];
    let [converged, grainy, smooth] = [(256, &[][..]), (1, &plain), (1, &[])]
        .map(|(n, set)| room(gpu, n, &[&metal, set].concat()));
    let errors = error(&smooth, &converged) / error(&grainy, &converged);
    assert!(errors < 0.5, "{errors}");
    assert!(room(gpu, 256, &[&metal[..], &plain].concat()).color == converged.color);
    let [smoothed, as_it_is] = [&[][..], &plain].map(|set| room(gpu, 1, &[&mirror, set].concat()));
    assert!(smoothed.color == as_it_is.color);
}

const NO_BOUNCES: &str = "reflection.diffuse_bounces=0";

/// A thin wall between a floor that light from a roof reaches and one that no light reaches, seen from above.
const WALL: &str = include_str!("first_pictures/wall.toml");
/// A sheet of paper beside a wall in one plane, with a lamp behind both.
const PAPER: &str = include_str!("first_pictures/paper.toml");

/// Floors on both sides of a wall are one plane, and their light stays apart.
#[test]
fn smoothed_light_stays_on_its_side_of_a_wall() {
    let Some(gpu) = gpu() else { return };
    for text in [WALL, PAPER] {
        let first = render(gpu, text, &["image.samples=1"], &[]);
        let converged = ["image.samples=64", "reflection.filter=false"];
        let converged = render(gpu, text, &converged, &[]);
        let is_dark = |x: u32, y: u32| color(&converged, x, y)[1] == 0.0;
        // One sample shows edges elsewhere.
        let around =
            |x: u32, y: u32| (y - 1..=y + 1).all(|y| (x - 1..=x + 1).all(|x| is_dark(x, y)));
        let pixels = (1..35).flat_map(|y| (1..63).map(move |x| (x, y)));
        let dark: Vec<_> = pixels.filter(|&(x, y)| around(x, y)).collect();
        assert!(dark.len() > 1000, "{}", dark.len());
        let leaked: f32 = dark.iter().map(|&(x, y)| color(&first, x, y)[1]).sum();
        assert!(leaked < 0.05, "{leaked}");
    }
}
