//! First pictures: several paths of one sample find what is behind glass, and light between surfaces is smoothed.

use crate::kit::{color, gpu, render};

/// A ball of rough glass in a room that glows, before dark slats.
const SCENE: &str = r#"
version = 1
[camera.main]
eye = [0, 0, 3]
target = [0, 0, 0]
fov_deg = 30
[image]
size = [32, 18]
tone_map = "none"
[environment]
zenith = [0, 0, 0]
horizon = [0, 0, 0]
ground = [0, 0, 0]
[material.glass]
transmission = 1
roughness = 0.3
[material.dark]
base_color = [0, 0, 0]
reflectivity = 0
[material.glow]
base_color = [0, 0, 0]
reflectivity = 0
emission = [1, 1, 1]
double_sided = true
[model.glass]
shape = { kind = "sphere", radius = 1, segments = 32 }
material = "glass"
[model.room]
shape = { kind = "box", size = [20, 20, 20] }
material = "glow"
[model.slat]
shape = { kind = "box", size = [0.5, 20, 0.1] }
material = "dark"
[[instance]]
model = "glass"
[[instance]]
model = "room"
[[instance]]
model = "slat"
translation = [-5, 0, -2]
repeat = { count = [11, 1, 1], step = [1, 0, 0] }
"#;

/// A pixel of rough glass shows light or a slat by one path; one sample follows four, so that errors are half as large: 0.23
/// in place of 0.45.
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
const ROOM: &str = r#"
version = 1
[camera.main]
eye = [0, 1.2, 1.9]
target = [0, 0.2, -0.5]
fov_deg = 60
[image]
size = [48, 27]
tone_map = "none"
[environment]
zenith = [0, 0, 0]
horizon = [0, 0, 0]
ground = [0, 0, 0]
[reflection]
method = "rt"
diffuse_bounces = 1
[light.up]
kind = "spot"
position = [0, 0.6, 1.2]
direction = [0, 1, 0]
outer_deg = 75
intensity_cd = 20
shadow = "ray"
[material.wall]
base_color = [0.8, 0.8, 0.8]
reflectivity = 0
double_sided = true
[material.floor]
checker = { colors = [[0.9, 0.9, 0.9], [0, 0.09, 0.09]], size_m = 0.5 }
reflectivity = 0
[model.room]
shape = { kind = "box", size = [4, 3, 4] }
material = "wall"
[model.block]
shape = { kind = "box", size = [3, 1, 1] }
material = "floor"
[[instance]]
model = "room"
translation = [0, 1.5, 0]
[[instance]]
model = "block"
translation = [0, -0.3, 0]
[[instance]]
model = "block"
translation = [0, 0, -1]
"#;

/// Light that one path in a pixel finds now and then is that of all around, but neither crosses edges nor blurs textures.
#[test]
fn light_between_surfaces_is_smooth_in_first_pictures() {
    let Some(gpu) = gpu() else { return };
    let of = |samples: u32, filter: bool| {
        let (samples, filter) = (
            format!("image.samples={samples}"),
            format!("reflection.filter={filter}"),
        );
        render(gpu, ROOM, &[&samples, &filter], &[])
    };
    let (grainy, smooth, converged) = (of(1, false), of(1, true), of(128, true));
    let pixels: Vec<_> = (0..27).flat_map(|y| (0..48).map(move |x| (x, y))).collect();
    let sum = |of: &dyn Fn(u32, u32) -> f32| pixels.iter().map(|&(x, y)| of(x, y)).sum::<f32>();
    let error = |picture| {
        sum(&|x, y| {
            let (a, b) = (color(picture, x, y)[1], color(&converged, x, y)[1]);
            (a - b).powi(2) / (b * b + 0.01)
        })
    };
    let light = |picture| sum(&|x, y| color(picture, x, y)[1]);
    let red_of_cyan = sum(&|x, y| match color(&converged, x, y)[0] < 1e-3 {
        true => color(&smooth, x, y)[0],
        false => 0.0,
    });
    let errors = error(&smooth) / error(&grainy);
    assert!(errors < 0.08, "{errors}");
    let kept = light(&smooth) / light(&grainy);
    assert!((kept - 1.0).abs() < 0.03, "{kept}");
    assert!(red_of_cyan < 0.01, "{red_of_cyan}");
}

/// A thin wall between a floor that light from a roof reaches and one that no light reaches, seen from above.
const WALL: &str = r#"
version = 1
[camera.main]
eye = [2.5, 6, 0.01]
target = [0, 0, 0]
fov_deg = 40
[image]
size = [64, 36]
tone_map = "none"
[environment]
zenith = [0, 0, 0]
horizon = [0, 0, 0]
ground = [0, 0, 0]
[reflection]
method = "rt"
diffuse_bounces = 2
[light.up]
kind = "spot"
position = [-1.2, 0.1, 0]
direction = [0, 1, 0]
outer_deg = 60
intensity_cd = 20
shadow = "ray"
[material.wall]
base_color = [0.8, 0.8, 0.8]
reflectivity = 0
double_sided = true
[model.floor]
shape = { kind = "box", size = [6, 0.1, 4] }
material = "wall"
[model.thin]
shape = { kind = "box", size = [0.03, 1, 4] }
material = "wall"
[model.roof]
shape = { kind = "box", size = [0.8, 0.02, 4] }
material = "wall"
[[instance]]
model = "floor"
translation = [0, -0.05, 0]
[[instance]]
model = "thin"
translation = [0, 0.5, 0]
[[instance]]
model = "thin"
translation = [-2, 0.5, 0]
[[instance]]
model = "roof"
translation = [-1.2, 0.9, 0]
"#;

/// Floors on both sides of a wall are one plane, and their light stays apart.
#[test]
fn smoothed_light_stays_on_its_side_of_a_wall() {
    let Some(gpu) = gpu() else { return };
    let of = |samples: &str| render(gpu, WALL, &[samples], &[]);
    let (first, converged) = (of("image.samples=1"), of("image.samples=64"));
    let is_dark = |x: u32, y: u32| color(&converged, x, y)[1] == 0.0;
    // One sample shows edges elsewhere.
    let around = |x: u32, y: u32| (y - 1..=y + 1).all(|y| (x - 1..=x + 1).all(|x| is_dark(x, y)));
    let pixels = (1..35).flat_map(|y| (1..63).map(move |x| (x, y)));
    let dark: Vec<_> = pixels.filter(|&(x, y)| around(x, y)).collect();
    assert!(dark.len() > 1000, "{}", dark.len());
    let leaked: f32 = dark.iter().map(|&(x, y)| color(&first, x, y)[1]).sum();
    assert!(leaked < 0.05, "{leaked}");
}
