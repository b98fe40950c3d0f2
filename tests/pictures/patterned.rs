//! Numbers and colors of materials that follow patterns: closed forms, and pairs that must agree.

use std::f32::consts::PI;

use reflet::render::{Picture, picture::aov::Aov};

use crate::kit::{color, floats, gpu, mean, render, renderer, scene, share_differing};

/// A wall in the plane z = 0, seen so that a pixel is 0.05 m wide and the middle of the picture is the origin.
const WALL: &str = r#"
version = 1
[image]
size = [40, 24]
tone_map = "none"
[camera.main]
eye = [0, 0, 3]
target = [0, 0, 0]
orthographic_height_m = 1.2
[environment]
color = [1, 1, 1]
shadow = "none"
[material.wall]
base_color = [0.5, 0.5, 0.5]
[model.wall]
shape = { kind = "box", size = [40, 40, 1] }
material = "wall"
[[instance]]
model = "wall"
translation = [0, 0, -0.5]
"#;

/// Width of a pixel of [`WALL`], meters.
const PIXEL_M: f32 = 0.05;

/// Place of a pixel's middle on the wall, meters.
fn place(pixel: usize) -> [f32; 2] {
    let (x, y) = ((pixel % 40) as f32, (pixel / 40) as f32);
    [(x - 19.5) * PIXEL_M, (11.5 - y) * PIXEL_M]
}

/// Distance to the nearest whole number.
fn from_whole(x: f32) -> f32 {
    (x - x.round()).abs()
}

#[test]
fn values_at_points_are_those_of_the_formulas() {
    let Some(gpu) = gpu() else { return };
    let text = WALL.replace(
        "base_color = [0.5, 0.5, 0.5]",
        r#"
        base_color = { pattern = "gradient", from = [0, 0.2, 1], to = [1, 0.2, 0], size_m = 1, offset_m = [-0.5, 0, 0] }
        roughness = { pattern = "stripes", from = 0.25, to = 0.75, size_m = 0.3, axis = [0, 2, 0], offset_m = [0, 0.1, 0] }
        metallic = { pattern = "checker", from = 0, to = 1, size_m = 0.4, offset_m = [0, 0, 0.2] }
        reflectivity = { pattern = "dots", from = 0.5, to = 0.125, size_m = 0.5 }
        emission = { pattern = "gradient", from = [0, 0, 0], to = [4, 2, 1], size_m = 1, axis = [-1, 0, 0] }
        emission_strength = 0.5
        "#,
    );
    for visibility in ["raster", "rays"] {
        let set = format!("image.visibility={visibility}");
        let planes = [Aov::Material, Aov::BaseColor, Aov::Emission];
        let picture = render(gpu, &text, &[&set], &planes);
        let [numbers, colors, emitted] = planes.map(|aov| floats(&picture, aov));
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

/// Spheres whose 16 numbers and colors count; `{key|value}` becomes a number or a pattern that is that number.
const ALL_KEYS: &str = r#"
version = 1
[image]
size = [96, 40]
tone_map = "none"
[camera.main]
eye = [0, 0.4, 5]
target = [0, 0, 0]
orthographic_height_m = 2.5
[environment]
zenith = [0.9, 0.9, 1]
horizon = [0.3, 0.5, 0.4]
ground = [0.4, 0.2, 0.1]
[light.lamp]
kind = "point"
position = [2, 3, 4]
intensity_cd = 40
[material.coated]
{base_color|[0.7, 0.3, 0.2]}
{metallic|0.25}
{roughness|0.375}
{clearcoat|0.75}
{clearcoat_roughness|0.25}
{emission|[0.1, 0.2, 0.05]}
[material.film]
{reflectivity|0.25}
{specular|0.5}
{specular_color|[0.9, 0.5, 0.6]}
{iridescence|0.75}
{iridescence_thickness_nm|320}
{roughness|0.125}
[material.cloth]
{sheen_color|[0.2, 0.6, 0.8]}
{sheen_roughness|0.375}
{anisotropy|0.5}
{alpha|0.75}
{transmission|0.25}
{roughness|0.5}
[model.coated]
shape = { kind = "sphere", radius = 0.8 }
material = "coated"
[model.film]
shape = { kind = "sphere", radius = 0.8 }
material = "film"
[model.cloth]
shape = { kind = "sphere", radius = 0.8 }
material = "cloth"
[[instance]]
model = "coated"
translation = [-1.9, 0, 0]
[[instance]]
model = "film"
[[instance]]
model = "cloth"
translation = [1.9, 0, 0]
"#;

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
    let plain = render(gpu, &written(|_, value| value.to_owned()), &[], &[]);
    let all = render(gpu, &written(|_, value| constant(value)), &[], &[]);
    let differing = share_differing(&plain, &all, 1);
    assert!(differing < 0.002, "{differing}");
}

/// A mirror beside a patterned ball, whose light is emission alone, so that methods have nothing else to differ by.
const MARBLE: &str = r#"
version = 1
[image]
size = [64, 36]
tone_map = "none"
[camera.main]
eye = [1.2, 0.7, 3]
target = [0.2, 0.3, 0]
fov_deg = 40
[material.ball]
base_color = [0, 0, 0]
reflectivity = 0
emission = { pattern = "marble", from = [0.9, 0.1, 0.1], to = [0.1, 0.2, 0.9], size_m = 0.2, axis = [1, 1, 0] }
[material.mirror]
metallic = 1
roughness = 0
[model.ball]
shape = { kind = "sphere", radius = 0.5 }
material = "ball"
[model.mirror]
shape = { kind = "plane", size = [6, 6] }
material = "mirror"
[[instance]]
model = "ball"
translation = [0, 0.6, 0]
[[instance]]
model = "mirror"
"#;

#[test]
fn rays_meet_the_pattern_that_the_screen_shows() {
    let Some(gpu) = gpu() else { return };
    let specialized = render(gpu, MARBLE, &[], &[]);
    // Rays find the same values of patterns as rasterization, which another test shows.
    let traced = render(gpu, MARBLE, &["reflection.method=rt"], &[]);
    let differing = share_differing(&specialized, &traced, 6);
    assert!(differing < 0.02, "rt: {differing}");
}

#[test]
#[ignore = "long: general pipelines, and paths"]
fn general_pipelines_and_paths_meet_the_same_pattern() {
    let Some(gpu) = gpu() else { return };
    let specialized = render(gpu, MARBLE, &[], &[]);
    let (desc, world) = scene(MARBLE, &[]);
    let camera = &world.cameras[0].value;
    let mut general = renderer(gpu, &desc, &world, true);
    let general = general.picture(gpu, camera, &[]);
    let general = general.unwrap_or_else(|e| panic!("{e}"));
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
        r#"
        base_color = [0, 0, 0]
        reflectivity = 0
        alpha_cutoff = 0.5
        alpha = { pattern = "dots", from = 1, to = 0, size_m = 0.2 }
        "#,
    );
    let picture = render(gpu, &text, &["image.samples=16"], &[]);
    let open = mean(&picture)[1];
    // The box's back has the same holes behind those of its front, as the view is straight.
    let expected = PI * 0.3 * 0.3;
    assert!((open - expected).abs() < 0.02, "{open}, not {expected}");
}

/// A floor below a panel whose emission rises linearly gets as much light in its middle as from a panel of the mean
/// emission, as the panel is symmetric about it, and more on the brighter side.
#[test]
fn patterned_emission_lights() {
    let Some(gpu) = gpu() else { return };
    let text = |emission: &str| {
        format!(
            r#"
version = 1
[image]
size = [48, 27]
tone_map = "none"
samples = 64
[camera.main]
eye = [0, 0.9, 6]
target = [0, 0, 0]
fov_deg = 30
[material.floor]
reflectivity = 0
[material.panel]
base_color = [0, 0, 0]
reflectivity = 0
light = true
emission = {emission}
[model.floor]
shape = {{ kind = "plane", size = [8, 8] }}
material = "floor"
[model.panel]
shape = {{ kind = "plane", size = [3, 3] }}
material = "panel"
[[instance]]
model = "floor"
[[instance]]
model = "panel"
translation = [0, 2.5, 0]
rotation_deg = [180, 0, 0]
"#
        )
    };
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
