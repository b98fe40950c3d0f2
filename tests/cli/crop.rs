//! `render --crop`: the pixels of the whole picture, and no others.

use super::*;
use crate::common::first_or_all;

/// Pixels of a PNG in a rectangle.
fn part(path: &Path, [x, y, width, height]: [u32; 4]) -> Vec<u8> {
    let whole = image::open(path).expect("a PNG").to_rgba8();
    image::imageops::crop_imm(&whole, x, y, width, height)
        .to_image()
        .into_raw()
}

#[test]
fn a_crop_has_the_pixels_of_the_whole_picture() {
    or_skip!(gpu_or_skip());
    let folder = folder("crop");
    let lamp = "[light.lamp]\nkind = \"rect\"\nposition = [1, 3, 1]\ntarget = [0, 0, 0]\nsize = [1, 1]\nintensity_cd = 9\n";
    // A rough floor is smoothed over neighbors, also of the surroundings of the crop.
    let scene = SCENE.replace("roughness = 0\n", "roughness = 0.1\n");
    fs::write(folder.join("scene.toml"), format!("{scene}{lamp}")).expect("written");
    let kinds = [
        ("path", "--method path --set reflection.diffuse_bounces=2"),
        ("hybrid", "--method hybrid --aov depth"),
        ("fog", "--method rt --set environment.fog.density=0.05"),
        (
            "alone",
            "--method hybrid --set reflection.reuse_light=false --samples 20",
        ),
    ];
    for (name, settings) in first_or_all(&kinds, 2) {
        let settings: Vec<_> = settings.split(' ').collect();
        let [whole, crop] = ["whole", "crop"].map(|kind| format!("{kind}-{name}.png"));
        let render = ["render", "scene.toml", "--size", "96x24"];
        let whole_picture = [&render[..], &settings, &["-o", &whole]].concat();
        exits(&folder, whole_picture, 0);
        let only = ["--crop", "9,7,16,11", "-o", &crop];
        exits(&folder, [&render[..], &settings, &only].concat(), 0);
        let want = part(&folder.join(&whole), [9, 7, 16, 11]);
        assert!(part(&folder.join(&crop), [0, 0, 16, 11]) == want, "{name}");
        let size = image::image_dimensions(folder.join(&crop)).expect("a PNG");
        assert_eq!(size, (16, 11), "{name}");
    }
    let size = image::image_dimensions(folder.join("crop-hybrid.depth.png")).expect("a PNG");
    assert_eq!(size, (16, 11));
}

#[test]
#[cfg(unix)]
fn watching_renders_again_after_each_save_and_keeps_the_last_good_picture() {
    use std::{
        process::Stdio,
        time::{Duration, Instant},
    };
    or_skip!(gpu_or_skip());
    let folder = folder("watch");
    let picture = folder.join("a.png");
    let project = |text: &str| fs::write(folder.join("reflet.toml"), text).expect("saved");
    project("[sizes]\nsmall = [16, 9]\n");
    let render = words("render scene.toml -o a.png --size small --watch");
    let errors = fs::File::create(folder.join("errors")).expect("a file");
    let mut child = super::reflet(&folder, &render)
        .stderr(Stdio::from(errors))
        .spawn()
        .expect("it starts");
    // Each wait ends with its event; the limit only ends a test that fails.
    let wait = |what: &str, is_there: &dyn Fn() -> bool| {
        let started = Instant::now();
        while !is_there() {
            assert!(started.elapsed() < Duration::from_secs(120), "no {what}");
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    let told = |text: &str| {
        let all = fs::read_to_string(folder.join("errors")).expect("a file");
        all.matches(text).count()
    };
    wait("first picture", &|| told("waiting for a save") > 0);
    let first = fs::read(&picture).expect("written");
    fs::write(
        folder.join("scene.toml"),
        SCENE.replace("eye = [0, 1, 3]", "eya = 3"),
    )
    .expect("saved");
    wait("message", &|| told("scene.toml:3:1") > 0);
    assert!(fs::read(&picture).expect("kept") == first);
    fs::write(
        folder.join("scene.toml"),
        SCENE.replace("eye = [0, 1, 3]", "eye = [1, 1, 2]"),
    )
    .expect("saved");
    wait("second picture", &|| {
        fs::read(&picture).expect("written") != first
    });
    // The size is the project's, so that its mistakes end the reading before the scene's files are known.
    project("[sizes]\nsmall = [16]\n");
    wait("message", &|| told("reflet.toml:2:9") > 0);
    let before = told("wrote ");
    project("[sizes]\nsmall = [16, 9]\n");
    wait("third picture", &|| told("wrote ") > before);
    let killed = std::process::Command::new("kill")
        .arg(child.id().to_string())
        .status();
    assert!(killed.expect("it runs").success());
    assert_eq!(child.wait().expect("it ends").code(), Some(143));
    assert_eq!(
        names(&folder),
        ["a.png", "errors", "reflet.toml", "scene.toml"]
    );
}
