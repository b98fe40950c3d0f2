//! Meshes that a script's `frame` deforms: each frame is the picture of the same mesh written so, and a mirror that it
//! moves shows what closed forms say.

use std::{fs, path::PathBuf};

use reflet::{
    render::{Picture, picture::aov::Aov},
    scene::{
        desc::{Method, Visibility},
        stages::{Animator, Scene},
    },
    world::{World, load},
};

use crate::kit::{color, gpu, integers, renderer};

const SCENE: &str = r#"
version = 1
script = "mesh.rhai"
params = { written = -1 }
timeline = { fps = 24, end = 40 }
[camera.main]
eye = [0.4, 1.1, 2.2]
target = [0, 0.5, 0]
fov_deg = 50
[image]
size = [64, 48]
[environment]
zenith = [0.3, 0.5, 0.9]
horizon = [0.8, 0.7, 0.5]
[light.sun]
kind = "directional"
direction = [0.5, -1, -0.6]
intensity_lux = 2
[material.floor]
roughness = 0
reflectivity = 0.5
[material.cloth]
base_color = [0.7, 0.1, 0.1]
roughness = 0.35
metallic = 1
double_sided = true
[model.floor]
shape = { kind = "plane", size = [6, 6] }
material = "floor"
[[instance]]
model = "floor"
"#;

/// A cloth of 13 × 9 vertices, in the pose of the frame `params.written` as it is written, or deformed by `frame`.
const CLOTH: &str = r#"
fn cloth(t) {
    let p = floats();
    for row in 0..=8 {
        for column in 0..=12 {
            let x = column / 12.0 - 0.5;
            let swing = 0.25 * (x + 0.5) * sin(9.0 * x - 7.0 * t);
            p.add(x, 0.25 + row / 10.0 + 0.1 * swing, swing);
        }
    }
    p
}

fn setup(ctx) {
    let indices = floats();
    let uv = floats();
    for row in 0..=8 {
        for column in 0..=12 {
            uv.add(column / 6.0, row / 8.0);
            let a = row * 13 + column;
            if row < 8 && column < 12 {
                indices.add(a, a + 1, a + 14);
                indices.add(a, a + 14, a + 13);
            }
        }
    }
    let written = ctx.params.written;
    let moves = written < 0;
    let t = if moves { 0.0 } else { written / ctx.fps };
    let shape = #{ kind: "mesh", positions: cloth(t), indices: indices, uv: uv, dynamic: moves };
    #{
        models: #{ flag: #{ shape: shape, material: "cloth" } },
        instances: [#{ model: "flag", name: "flag", dynamic: true }],
    }
}

fn frame(ctx) {
    if ctx.params.written < 0 {
        ctx.mesh("flag", cloth(ctx.t));
    }
}
"#;

/// The scene with its script in a folder of its own.
fn load(name: &str, text: &str, script: &str, set: &[String]) -> (Scene, World) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join("mesh.rhai"), script).expect("a script");
    let all = |errors: Vec<_>| -> String { errors.iter().map(ToString::to_string).collect() };
    let read = Scene::from_text(text, &folder.join("mesh.toml"), set);
    let (scene, _) = read.unwrap_or_else(|errors| panic!("{}", all(errors)));
    let loaded = load::load(&scene, &load::LoadOptions::default());
    let world = loaded.unwrap_or_else(|errors| panic!("{}", all(errors)));
    (scene, world)
}

fn pose(scene: &Scene, world: &mut World, frame: u32) {
    let state = Animator::new(scene).pose(frame).expect("poses");
    world.apply(&state).expect("applies");
}

#[test]
fn a_deformed_mesh_is_the_same_mesh_as_written() {
    let Some(gpu) = gpu() else { return };
    let ways = [
        (Method::Hybrid, Visibility::Raster, "map", 0.0),
        // Grooves have tangents, which follow the deformed vertices.
        (Method::Rt, Visibility::Rays, "ray", 0.7),
    ];
    for (method, visibility, shadow, anisotropy) in ways {
        let mut set = vec![format!("light.sun.shadow={shadow}")];
        if anisotropy > 0.0 {
            set.push(format!("material.cloth.anisotropy={anisotropy}"));
        }
        let (mut scene, mut world) = load("script-mesh", SCENE, CLOTH, &set);
        scene.desc.reflection.method = method;
        scene.desc.image.visibility = visibility;
        let aovs = [Aov::Ids, Aov::HitIds];
        let mut moving = renderer(gpu, &scene, &world, false);
        let mut before: Option<Picture> = None;
        for frame in [31, 4] {
            pose(&scene, &mut world, frame);
            moving.update(gpu, &world).expect("the same meshes");
            let camera = &world.cameras[0].value;
            let picture = moving.picture(gpu, camera, &aovs).expect("renders");

            let mut set = set.clone();
            set.push(format!("params.written={frame}"));
            let (mut as_written, mut still) = load("script-mesh", SCENE, CLOTH, &set);
            as_written.desc.reflection.method = method;
            as_written.desc.image.visibility = visibility;
            pose(&as_written, &mut still, frame);
            assert!(still.deformed.is_empty(), "nothing deforms it");
            let mut fixed = renderer(gpu, &as_written, &still, false);
            let expected = fixed.picture(gpu, camera, &aovs).expect("renders");

            let name = format!("{method:?}, frame {frame}");
            for aov in aovs {
                assert_eq!(integers(&picture, aov), integers(&expected, aov), "{name}");
            }
            assert_eq!(picture.color, expected.color, "{name}");
            let moved = before.as_ref().map(|b| b.color != picture.color);
            assert_ne!(moved, Some(false), "{name}: frames differ");
            before = Some(picture);
        }
    }
}

/// A ball that only mirrors show, over a mirror whose height the script moves by its vertices.
const MIRROR: &str = r#"
version = 1
script = "mesh.rhai"
timeline = { fps = 10, end = 9 }
[camera.main]
eye = [0, 1.5, 3]
target = [0, 0, 0]
fov_deg = 60
[image]
size = [96, 96]
tone_map = "none"
[environment]
zenith = [0, 0, 0]
horizon = [0, 0, 0]
ground = [0, 0, 0]
[material.mirror]
base_color = [0, 0, 0]
reflectivity = 1
roughness = 0
[material.glow]
base_color = [0, 0, 0]
emission = [1, 1, 1]
[model.ball]
shape = { kind = "sphere", radius = 0.12 }
material = "glow"
[[instance]]
model = "ball"
translation = [0.5, 0.9, -0.6]
visible = false
"#;

const RISES: &str = r#"
fn at(h) {
    let p = floats();
    p.add(-9, h, 9);
    p.add(9, h, 9);
    p.add(9, h, -9);
    p.add(-9, h, -9);
    p
}

fn setup(ctx) {
    let shape = #{ kind: "mesh", positions: at(0.0), indices: [0, 1, 2, 0, 2, 3], dynamic: true };
    #{
        models: #{ water: #{ shape: shape, material: "mirror" } },
        instances: [#{ model: "water" }],
    }
}

fn frame(ctx) {
    ctx.mesh("water", at(-0.5 * ctx.t), floats_up());
}

fn floats_up() {
    let n = floats();
    for i in 0..4 {
        n.add(0, 1, 0);
    }
    n
}
"#;

#[test]
fn a_mirror_that_a_script_moves_shows_the_image_at_twice_its_height() {
    let Some(gpu) = gpu() else { return };
    let (mut scene, mut world) = load("script-mirror", MIRROR, RISES, &[]);
    for method in [Method::Hybrid, Method::Rt] {
        scene.desc.reflection.method = method;
        let mut renderer = renderer(gpu, &scene, &world, false);
        for frame in [8, 0, 4] {
            pose(&scene, &mut world, frame);
            renderer.update(gpu, &world).expect("the same meshes");
            let camera = &world.cameras[0].value;
            let picture = renderer.picture(gpu, camera, &[]).expect("renders");
            let (mut sum, mut x_sum, mut y_sum) = (0.0, 0.0, 0.0);
            for (x, y) in (0..96).flat_map(|y| (0..96).map(move |x| (x, y))) {
                let light = color(&picture, x, y)[0];
                sum += light;
                x_sum += light * (x as f32 + 0.5);
                y_sum += light * (y as f32 + 0.5);
            }
            // The image of the ball lies as far below the mirror as the ball is above it.
            let height = -0.05 * frame as f32;
            let image = glam::Vec3::new(0.5, 2.0 * height - 0.9, -0.6);
            let forward = (camera.target - camera.eye).normalize();
            let right = forward.cross(camera.up).normalize();
            let to_image = image - camera.eye;
            let half_px = 48.0 / 30_f32.to_radians().tan() / to_image.dot(forward);
            let up = right.cross(forward);
            let expected = [
                48.0 + half_px * to_image.dot(right),
                48.0 - half_px * to_image.dot(up),
            ];
            let name = format!("{method:?}, frame {frame}");
            assert!(sum > 10.0, "{name}: the ball is seen in the mirror: {sum}");
            let found = [x_sum / sum, y_sum / sum];
            // A ball's outline in perspective is an ellipse whose middle lies a little outwards.
            let off = [0, 1].map(|i| (found[i] - expected[i]).abs());
            assert!(
                off.iter().all(|off| *off < 0.5),
                "{name}: {found:?}, {expected:?}"
            );
        }
    }
}
