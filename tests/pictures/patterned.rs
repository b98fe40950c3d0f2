//! Numbers and colors of materials that follow patterns: closed forms, and pairs that must agree.

use crate::{decals::place, kit::*};

/// A wall in the plane z = 0, seen so that a pixel is 0.05 m wide and the middle of the picture is the origin.
const WALL: &str = include_str!("patterned/wall.toml");

/// Distance to the nearest whole number.
fn from_whole(x: f32) -> f32 {
    (x - x.round()).abs()
}

#[test]
fn values_at_points_are_those_of_the_formulas() {
    let Some(gpu) = gpu() else { return };
    let text = WALL.replace(
        "base_color = [0.5, 0.5, 0.5]",
        include_str!("patterned/values_at_points_are_those_of_the_formulas.toml"),
    );
    for visibility in ["raster", "rays"] {
        let set = format!("image.visibility={visibility}");
        let planes = [Aov::Material, Aov::BaseColor, Aov::Emission, Aov::Normal];
        let picture = render(gpu, &text, &[&set], &planes);
        let [numbers, colors, emitted, normals] = planes.map(|aov| floats(&picture, aov));
        let mut compared = [0; 3];
        for pixel in 0..40 * 24 {
            let [x, y] = place(pixel);
            let close = |found: f32, expected: f32, of: &str| {
                let error = (found - expected).abs();
                assert!(error < 2e-3, "{of} at {x}, {y}: {found}, not {expected}");
            };
            let along = (x + 0.5).clamp(0.0, 1.0);
            close(colors[3 * pixel], along, "red");
            close(colors[3 * pixel + 1], 0.2, "green");
            close(colors[3 * pixel + 2], 1.0 - along, "blue");
            close(emitted[3 * pixel], 2.0 * (-x).clamp(0.0, 1.0), "emission");
            let slope = if y > 0.0 { 0.5_f32 } else { 0.0 };
            if y.abs() > 0.08 {
                close(normals[3 * pixel + 1], -slope / slope.hypot(1.0), "relief");
            }
            let band = (y - 0.1) / 0.3;
            if from_whole(band) > 0.12 {
                let expected = [0.25, 0.75][band.floor() as i32 as usize & 1];
                close(numbers[3 * pixel], expected, "roughness");
                compared[0] += 1;
            }
            let cell = [x / 0.4, y / 0.4];
            if cell.iter().all(|c| from_whole(*c) > 0.1) {
                // The wall's front is in the first cell along Z, 0.3 m past the pattern's origin.
                let odd = cell.iter().map(|c| c.floor() as i32).sum::<i32>() & 1;
                close(numbers[3 * pixel + 1], odd as f32, "metalness");
                compared[1] += 1;
            }
            let offset = [x, y].map(|c| from_whole(c / 0.5));
            let distance = offset[0].hypot(offset[1]);
            if (distance - 0.3).abs() > 0.06 {
                let expected = if distance < 0.3 { 0.125 } else { 0.5 };
                close(numbers[3 * pixel + 2], expected, "reflectivity");
                compared[2] += 1;
            }
        }
        assert!(compared.iter().all(|n| *n > 400), "{compared:?}");
    }
}

/// Spheres and a leaf whose numbers and colors count; `{key|value}` becomes a number or a pattern that is that number.
const ALL_KEYS: &str = include_str!("patterned/all_keys.toml");

/// [`ALL_KEYS`] with each value written by a function of its key and value.
fn written(value: impl Fn(&str, &str) -> String) -> String {
    let line = |line: &str| match line.strip_prefix('{').and_then(|l| l.strip_suffix('}')) {
        Some(pair) => {
            let (key, number) = pair.split_once('|').expect("a key and its value");
            format!("{key} = {}\n", value(key, number))
        }
        None => format!("{line}\n"),
    };
    ALL_KEYS.lines().map(line).collect()
}

fn constant(value: &str) -> String {
    format!("{{ pattern = \"noise\", from = {value}, to = {value}, size_m = 0.3 }}")
}

#[test]
fn a_pattern_of_one_value_is_that_value() {
    let Some(gpu) = gpu() else { return };
    let rt = ["reflection.method=rt"]; // the march, which has pipelines of its own, reads no materials
    // A thing out of sight has a pattern, so that both pictures share their pipelines.
    let unseen = include_str!("patterned/unseen.toml").replace("PATTERN", &constant("0.5"));
    let [plain, all] = [str::to_owned, constant]
        .map(|value| written(|_, number| value(number)) + &*unseen)
        .map(|text| render(gpu, &text, &rt, &[]));
    let differing = share_differing(&plain, &all, 1);
    assert!(differing < 0.002, "{differing}");
}

#[test]
fn colors_of_balls_are_filtered_as_patterns_are() {
    let Some(gpu) = gpu() else { return };
    let shown = |set: &str| {
        let ball = "model.wall.shape={ kind=\"sphere\", radius=0.5 }";
        render(gpu, WALL, &[ball, set, "material.wall.unlit=true"], &[]).color
    };
    let color =
        "material.wall.base_color={ pattern=\"dots\", from=[0, 0, 0], to=[1, 1, 1], size_m=0.02 }";
    let pattern =
        "material.wall={ pattern={ kind=\"dots\", colors=[[0, 0, 0], [1, 1, 1]], size_m=0.02 } }";
    let [color, pattern] = [color, pattern].map(shown);
    let apart = color.iter().zip(&pattern).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f32::max) < 1e-3);
}

/// A mirror beside a patterned ball, whose light is emission alone, so that methods have nothing else to differ by.
const MARBLE: &str = include_str!("patterned/marble.toml");

#[test]
fn rays_meet_the_pattern_that_the_screen_shows() {
    let Some(gpu) = gpu() else { return };
    let specialized = render(gpu, MARBLE, &[], &[]);
    // Rays find the same values of patterns as rasterization, which another test shows.
    let traced = render(gpu, MARBLE, &["reflection.method=rt"], &[]);
    let differing = share_differing(&specialized, &traced, 6);
    assert!(differing < 0.02, "rt: {differing}");
    if !is_long() {
        return;
    }
    let (desc, world) = scene(MARBLE, &[]);
    let mut general = renderer(gpu, &desc, &world, true);
    let general = general.first_view(&world, &[]);
    let differing = share_differing(&specialized, &general, 1);
    assert!(differing < 0.005, "general: {differing}");
    let samples = ["image.samples=16"];
    let many = render(gpu, MARBLE, &samples, &[]);
    let path = render(
        gpu,
        MARBLE,
        &["image.samples=16", "reflection.method=path"],
        &[],
    );
    let differing = share_differing(&many, &path, 12);
    assert!(differing < 0.02, "path: {differing}");
}

/// Holes that a pattern cuts leave the share of the wall that its dots leave, in the picture and in shadows.
#[test]
fn patterns_cut_holes() {
    let Some(gpu) = gpu() else { return };
    let text = WALL.replace(
        "base_color = [0.5, 0.5, 0.5]",
        include_str!("patterned/patterns_cut_holes.toml"),
    );
    let picture = render(gpu, &text, &["image.samples=16"], &[]);
    let open = mean(&picture)[1];
    // Holes in the box's back lie behind the holes in its front, as the view is straight.
    let expected = PI * 0.3 * 0.3;
    assert!((open - expected).abs() < 0.02, "{open}, not {expected}");
}

/// A floor below a panel whose emission rises linearly gets as much light in its middle as from a panel of the mean
/// emission, as the panel is symmetric about it, and more on the brighter side.
#[test]
fn patterned_emission_lights() {
    let Some(gpu) = gpu() else { return };
    let text = |emission: &str| include_str!("patterned/panel.toml").replace("EMISSION", emission);
    let even = render(gpu, &text("[2, 2, 2]"), &[], &[]);
    let rising = "{ pattern = \"gradient\", from = [0, 0, 0], to = [4, 4, 4], size_m = 3, offset_m = [-1.5, 0, 0] }";
    let rising = render(gpu, &text(rising), &[], &[]);
    let column = |picture: &Picture, x: u32| -> f32 {
        let rows = [-1_i32, 0, 1].map(|dx| (13..17).map(move |y| (x.saturating_add_signed(dx), y)));
        let values: Vec<f32> = rows
            .into_iter()
            .flatten()
            .map(|(x, y)| color(picture, x, y)[0])
            .collect();
        values.iter().sum::<f32>() / values.len() as f32
    };
    let [middle, same] = [&rising, &even].map(|p| 0.5 * (column(p, 23) + column(p, 24)));
    assert!(
        same > 0.2 && (middle - same).abs() < 0.03 * same,
        "{middle}, not {same}"
    );
    let [left, right] = [9, 38].map(|x| column(&rising, x) / column(&even, x));
    assert!(left < 0.85 && right > 1.15, "{left}, {right}");
}

#[test]
fn patterns_finer_than_pixels_show_their_means() {
    let Some(gpu) = gpu() else { return };
    for (kind, own_mean) in [
        ("marble", 0.5),
        ("wood", 0.5),
        ("voronoi", 0.55),
        ("cells", 0.5),
    ] {
        let reds = |size_m: f32| {
            let color = format!(
                "material.wall.base_color={{ pattern=\"{kind}\", from=[0, 0, 0], to=[1, 1, 1], size_m={size_m} }}"
            );
            let picture = render(gpu, WALL, &[&color], &[Aov::BaseColor]);
            let reds: Vec<f32> = floats(&picture, Aov::BaseColor)
                .chunks(3)
                .map(|c| c[0])
                .collect();
            let mean = reds.iter().sum::<f32>() / reds.len() as f32;
            (
                mean,
                reds.iter().map(|r| (r - mean).abs()).sum::<f32>() / reds.len() as f32,
            )
        };
        let [(mean, spread), (fine_mean, fine_spread)] = [0.15, 0.01].map(reds);
        assert!(
            (mean - own_mean).abs() < 0.06 && spread > 0.12,
            "{kind}: {mean}, {spread}"
        );
        assert!(
            (fine_mean - own_mean).abs() < 0.02 && fine_spread < 0.02,
            "{kind}: {fine_mean}"
        );
    }
}

#[test]
fn instances_show_their_own_parts_of_a_pattern_where_asked() {
    let Some(gpu) = gpu() else { return };
    let halves = |own: bool| {
        let text = WALL.replace("size = [40, 40, 1]", "size = [1, 4, 1]").replace(
            "base_color = [0.5, 0.5, 0.5]",
            &format!("base_color = {{ pattern = \"cells\", from = [0, 0, 0], to = [1, 1, 1], size_m = 0.1, per_instance = {own} }}"),
        );
        let text = text.replace(
            "translation = [0, 0, -0.5]",
            "translation = [-0.5, 0, -0.5]",
        ) + "[[instance]]\nmodel = \"wall\"\ntranslation = [0.5, 0, -0.5]\n";
        let picture = render(gpu, &text, &[], &[Aov::BaseColor]);
        let reds = floats(&picture, Aov::BaseColor);
        let differs = |at: &usize| (reds[3 * at] - reds[3 * (at + 20)]).abs() > 0.01;
        (0..40 * 24)
            .filter(|at| at % 40 < 20)
            .filter(differs)
            .count()
    };
    assert_eq!(halves(false), 0);
    assert!(halves(true) > 300);
}
