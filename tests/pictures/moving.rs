//! Animated values give the same picture as static ones: every number of materials, spots and
//! cameras, by track and by script.

use std::path::PathBuf;

use crate::{
    common::{cases, words},
    kit::*,
};

/// A wall with a checker and one with pictures of an alpha that grows to the right, under a spot.
const SCENE: &str = include_str!("moving/scene.toml");

fn folder(name: &str) -> PathBuf {
    let folder = kept_folder(&format!("moving-{name}"), &[]);
    let pixel = |x: u32, y: u32| {
        let [u, v] = [x, y].map(|i| (i * 16) as u8);
        image::Rgba([255 - u / 2, 128 + v / 4, 220, u])
    };
    let leaf = image::RgbaImage::from_fn(16, 16, pixel);
    leaf.save(folder.join("leaf.png"))
        .expect("the image can be written");
    folder
}

/// Pictures of two frames, one after the other with the same renderer.
fn frames(folder: &Path, text: &str, set: &[&str], wanted: [u32; 2]) -> Option<[Picture; 2]> {
    let gpu = gpu()?;
    let (scene, mut world) = film_of(&folder.join("scene.toml"), text, set);
    let mut renderer = renderer(gpu, &scene, &world, false);
    Some(wanted.map(|frame| {
        pose(&scene, &mut world, frame);
        renderer.moved_view(&world, &[])
    }))
}

/// Materials, lights and cameras of the world in the third frame.
fn posed(folder: &Path, text: &str) -> String {
    let (scene, mut world) = film_of(&folder.join("scene.toml"), text, &[]);
    pose(&scene, &mut world, 2);
    let cameras = world.cameras.iter().map(|camera| &camera.value);
    let cameras: Vec<_> = cameras.collect();
    // A script may move every light, a track moves the light that it names.
    let lights = world.lights.iter().map(|light| &light.desc);
    let lights: Vec<_> = lights.collect();
    format!("{:?} {lights:?} {cameras:?}", world.materials)
}

/// Largest difference of a channel.
fn difference(a: &Picture, b: &Picture) -> f32 {
    let all = (0..a.size[1]).flat_map(|y| (0..a.size[0]).map(move |x| (x, y)));
    let of = |(x, y)| {
        let (a, b) = (color(a, x, y), color(b, x, y));
        (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f32::max)
    };
    all.map(of).fold(0.0, f32::max)
}

/// Kind, name, animated key and override for the still scene, and its value in each.
const MOVES: &str = include_str!("moving/moves.txt");

#[test]
fn moved_scene_equals_the_scene_written_in_that_pose() {
    let folder = folder("numbers");
    let [before, _] = or_skip!(frames(&folder, SCENE, &[], [0, 0]));
    for (moved, value) in sampled(cases(MOVES), 2) {
        let Ok([kind, name, key, path]) = <[&str; 4]>::try_from(words(moved)) else {
            panic!("{moved}");
        };
        let set = format!("{kind}.{name}.{path}={value}");
        let [still, _] = or_skip!(frames(&folder, SCENE, &[&set], [0, 0]));
        let keys = format!("{{ curve = \"step\", keys = [{{ at_s = 1, value = {value} }}] }}");
        let track = format!("{SCENE}[motion.{kind}.{name}]\n{key} = {keys}\n");
        let frame =
            format!("if ctx.frame > 1 {{ ctx.{kind}(\"{name}\", #{{ {key}: {value} }}); }}");
        let script = format!("fn frame(ctx) {{ {frame} }}");
        fs::write(folder.join("move.rhai"), script).expect("the script can be written");
        let script = format!("script = \"move.rhai\"\n{SCENE}");
        let [_, after] = or_skip!(frames(&folder, &track, &[], [0, 2]));
        let (far, near) = (difference(&before, &after), difference(&still, &after));
        assert!(far > 0.01, "{key} by a track changes nothing: {far}");
        assert!(
            near < 1e-3,
            "{key} by a track is not as it is written: {near}"
        );
        // A script that makes the same world gives the same picture.
        let [by_track, by_script] = [track, script].map(|text| posed(&folder, &text));
        assert_eq!(by_track, by_script, "{key} by a script is another");
    }
}

#[test]
fn leaves_that_are_cut_away_over_time_are_there_again_in_the_first_frame() {
    let folder = folder("cutoff");
    let keys = "{ keys = [{ at_s = 0, value = 0 }, { at_s = 2, value = 1 }] }";
    let text = format!("{SCENE}[motion.material.leaf]\nalpha_cutoff = {keys}\n");
    let [alone, _] = or_skip!(frames(&folder, &text, &[], [0, 0]));
    let [gone, again] = or_skip!(frames(&folder, &text, &[], [4, 0]));
    assert_eq!(
        alone.color, again.color,
        "a frame depends on those before it"
    );
    // The environment is visible behind the cut-out.
    let behind = [0.2, 0.3, 0.4];
    assert_color(&gone, 29, 12, behind, 1e-3);
    let before = color(&alone, 29, 12);
    let far = (0..3).any(|i| (before[i] - behind[i]).abs() > 0.05);
    assert!(far, "{before:?}");
}
