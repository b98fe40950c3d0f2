//! Pictures of animated files: moving objects and their reflections, independence of frames, and
//! bare models.

use std::path::PathBuf;

use glam::{Quat, camera::rh};
use reflet::{scene::desc::CameraDesc, world::load};

use crate::{
    common::{animated::write_arm, program::exits},
    kit::*,
};

const SCENE: &str = include_str!("animation/scene.toml");

fn folder(name: &str) -> PathBuf {
    let folder = kept_folder(&format!("animation-{name}"), &[]);
    write_arm(&folder);
    folder
}

fn read(folder: &Path, text: &str) -> (Scene, World) {
    let (scene, warnings) = Scene::from_text(text, &folder.join("scene.toml"), &[]).expect("valid");
    assert_eq!(warnings, []);
    let world = load::load(&scene, &load::LoadOptions::default()).expect("valid");
    (scene, world)
}

/// Pictures of these frames, all with one renderer.
fn film(folder: &Path, text: &str, frames: &[u32]) -> Option<Vec<Picture>> {
    let gpu = gpu()?;
    let (scene, mut world) = read(folder, text);
    let mut renderer = renderer(gpu, &scene, &world, false);
    let pictures = frames.iter().map(|frame| {
        pose(&scene, &mut world, *frame);
        renderer.moved_view(&world, &[])
    });
    Some(pictures.collect())
}

/// Pixel that shows a point.
fn pixel(camera: &CameraDesc, size: [u32; 2], world: Vec3) -> [u32; 2] {
    let view = rh::view::look_at_mat4(camera.eye, camera.target, camera.up);
    let aspect = size[0] as f32 / size[1] as f32;
    let fov = camera.fov_deg.to_radians();
    let clip =
        rh::proj::directx::perspective_infinite_reverse(fov, aspect, camera.near_in(1.0)) * view;
    let point = clip.project_point3(world);
    let at = |x: f32, side: u32| ((x * 0.5 + 0.5) * side as f32) as u32;
    [at(point.x, size[0]), at(-point.y, size[1])]
}

#[test]
fn a_moving_node_and_its_reflection_are_where_they_should_be() {
    let folder = folder("reflection");
    let frames = [0, 4, 8];
    for method in ["hybrid", "rt"] {
        let text = format!("{SCENE}[reflection]\nmethod = \"{method}\"\n");
        let pictures = or_skip!(film(&folder, &text, &frames));
        let camera = read(&folder, &text).0.cameras[0].value.clone();
        for (picture, frame) in pictures.iter().zip(frames) {
            let share = frame as f32 / 8.0;
            let turn = Quat::from_rotation_y(share * std::f32::consts::FRAC_PI_2);
            let hand = turn * Vec3::X + Vec3::Y * (0.5 + 0.5 * share);
            let mirrored = hand * Vec3::new(1.0, -1.0, 1.0);
            for seen in [hand, mirrored] {
                let [x, y] = pixel(&camera, picture.size, seen);
                assert_color(picture, x, y, [1.0, 0.0, 0.0], 0.02);
            }
            // It is absent from its positions in other frames.
            let [x, y] = pixel(&camera, picture.size, Vec3::new(-1.0, 0.5, 0.0));
            assert!(color(picture, x, y)[0] < 0.5);
        }
    }
}

#[test]
fn a_frame_alone_is_the_frame_of_the_film() {
    let folder = folder("alone");
    let all = or_skip!(film(&folder, SCENE, &[0, 3, 16, 5, 9]));
    for (i, frame) in [0, 3, 16, 5, 9].into_iter().enumerate() {
        let alone = film(&folder, SCENE, &[frame]).expect("there is a device");
        assert!(all[i].display == alone[0].display, "frame {frame}");
        assert!(all[i].color == alone[0].color, "frame {frame}");
    }
    for (i, a) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|b| a.display != b.display));
    }
}

/// An instance with scale 0 is invisible to rasterization, rays and shadow maps.
#[test]
fn what_is_hidden_leaves_no_trace() {
    let folder = folder("hidden");
    let sun =
        "[light.sun]\nkind = \"directional\"\ndirection = [0.2, -1, 0.1]\nintensity_lux = 3\n";
    let text = format!("{SCENE}{sun}");
    let pictures = or_skip!(film(&folder, &text, &[8, 16]));
    let json = fs::read_to_string(folder.join("arm.gltf")).expect("it is there");
    let without = json.replace("\"name\": \"hand\", \"mesh\": 1,", "\"name\": \"hand\",");
    assert_ne!(json, without);
    fs::write(folder.join("arm.gltf"), without).expect("written");
    let bare = film(&folder, &text, &[16]).expect("there is a device");
    assert!(pictures[1].display == bare[0].display, "hidden, but seen");
    assert!(
        pictures[0].display != bare[0].display,
        "before that it is there"
    );
}

#[test]
fn materials_of_files_change_over_time() {
    let folder = folder("material");
    let motion = "[motion.model.arm.material.glow]\n\
        emission = { keys = [{ at_s = 0, value = [1, 0, 0] }, { at_s = 2, value = [0, 1, 0] }] }\n";
    let text = format!("{SCENE}{motion}").replace("[\"swing\", \"lift\"]", "\"swing\"");
    let pictures = or_skip!(film(&folder, &text, &[0, 8]));
    let camera = read(&folder, &text).0.cameras[0].value.clone();
    for (picture, hand, expected) in [
        (&pictures[0], Vec3::new(1.0, 0.5, 0.0), [1.0, 0.0, 0.0]),
        (&pictures[1], Vec3::new(0.0, 0.5, -1.0), [0.5, 0.5, 0.0]),
    ] {
        for seen in [hand, hand * Vec3::new(1.0, -1.0, 1.0)] {
            let [x, y] = pixel(&camera, picture.size, seen);
            assert_color(picture, x, y, expected, 0.02);
        }
    }
}

/// Runs `reflet render`, returns standard error.
#[track_caller]
fn render(folder: &Path, arguments: &[&str], code: i32) -> String {
    let [_, said] = exits(folder, [&["render"], arguments].concat(), code);
    said
}

#[test]
fn bare_model_renders_as_a_film() {
    or_skip!(gpu());
    let folder = folder("bare");
    let frames = [
        "arm.gltf", "--size", "32x24", "-o", "f.##.png", "--resume", "--frames",
    ];
    // The animations move different objects: both are played, the longer takes 2 s.
    let text = render(&folder, &[&frames[..], &["0,24,48"]].concat(), 0);
    assert_eq!(text.matches("wrote").count(), 3, "{text}");
    let picture = |name: &str| fs::read(folder.join(name)).expect("it is there");
    let film = ["f.00.png", "f.24.png", "f.48.png"].map(picture);
    assert!(film[0] != film[1] && film[1] != film[2]);
    let text = render(&folder, &[&frames[..], &["0,1,24,48"]].concat(), 0);
    assert_eq!(text.matches("kept").count(), 3, "{text}");
    assert_eq!(text.matches("wrote").count(), 1, "{text}");
    let text = render(&folder, &[&frames[..], &["49"]].concat(), 2);
    assert!(text.contains("which has 0 to 48"), "{text}");
    let slow = ["--set", "timeline.fps=6"];
    let text = render(&folder, &[&frames[..], &["all"], &slow[..]].concat(), 0);
    assert_eq!(text.matches("wrote").count(), 13, "{text}");
    // A single animation gives another film, with its own length.
    let one = ["--set", "model.model.animation.name=swing"];
    let text = render(&folder, &[&frames[..], &["0,24"], &one[..]].concat(), 0);
    assert_eq!(text.matches("wrote").count(), 2, "{text}");
    assert_ne!(picture("f.24.png"), film[1]);
}

#[test]
fn resume_depends_on_the_played_animation() {
    or_skip!(gpu());
    let folder = folder("resume");
    fs::write(folder.join("scene.toml"), SCENE).expect("written");
    let frames = [
        "scene.toml",
        "--size",
        "32x24",
        "-o",
        "f.#.png",
        "--resume",
        "--frames",
        "0-2",
    ];
    render(&folder, &frames, 0);
    assert_eq!(render(&folder, &frames, 0).matches("kept").count(), 3);
    fs::write(
        folder.join("scene.toml"),
        SCENE.replace("once", "ping_pong"),
    )
    .expect("written");
    assert_eq!(render(&folder, &frames, 0).matches("wrote").count(), 3);
    let bytes = fs::read(folder.join("arm.bin")).expect("it is there");
    let mut moved = bytes.clone();
    let last = moved.len() - 1;
    moved[last] ^= 0x01; // the last key of the last animation
    fs::write(folder.join("arm.bin"), moved).expect("written");
    assert_eq!(render(&folder, &frames, 0).matches("wrote").count(), 3);
}
