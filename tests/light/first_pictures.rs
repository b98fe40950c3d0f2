//! First pictures of glass: several paths of one sample find what is behind it.

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
