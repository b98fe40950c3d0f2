//! `--denoise`, with and without its library.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{exits, folder, names, reflet};
use crate::common::gpu_or_skip;

const RENDER: [&str; 8] = [
    "render",
    "scene.toml",
    "-o",
    "a.png",
    "--size",
    "96x64",
    "--denoise",
    "--aov=normal",
];

#[test]
fn without_its_library_denoising_says_what_to_install() {
    let folder = folder("denoise-missing");
    let mut command = reflet(&folder, &RENDER);
    let output = command.env("REFLET_OIDN", "/nowhere").output();
    let output = output.expect("the program starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    for part in ["/nowhere", "REFLET_OIDN", "pip install"] {
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(names(&folder), ["scene.toml"]);
}

/// Folder of the library: `REFLET_OIDN` of the tests, otherwise the one of `tools/setup.sh`.
fn library() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os("REFLET_OIDN") {
        return Some(folder.into());
    }
    let lib = Path::new(env!("CARGO_MANIFEST_DIR")).join(".venv/lib");
    let pythons = fs::read_dir(lib).ok()?.filter_map(Result::ok);
    let mut folders = pythons.map(|python| python.path().join("site-packages/pyoidn/oidn/lib"));
    folders.find(|folder| folder.is_dir())
}

#[test]
fn with_its_library_grain_goes_and_edges_stay() {
    let Some(library) = library() else {
        eprintln!(
            "SKIPPED: no Open Image Denoise in REFLET_OIDN or .venv (tools/setup.sh installs it)"
        );
        return;
    };
    if gpu_or_skip().is_none() {
        return;
    }
    let folder = folder("denoise");
    let scene = fs::read_to_string(folder.join("scene.toml")).expect("a scene");
    let soft = scene + "angle_deg = 40\nshadow = \"ray\"\n[image]\nlight_rays = 1\n";
    fs::write(folder.join("scene.toml"), soft).expect("a scene");
    let mut command = reflet(&folder, &RENDER);
    let output = command.env("REFLET_OIDN", library).output();
    let output = output.expect("the program starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    let read = |name: &str| {
        image::open(folder.join(name))
            .expect("a picture")
            .to_luma32f()
    };
    let clean = read("a.png");
    assert_eq!(names(&folder), ["a.normal.png", "a.png", "scene.toml"]);
    let plain: Vec<&str> = RENDER.into_iter().filter(|a| *a != "--denoise").collect();
    exits(&folder, &plain, 0);
    let truth: Vec<&str> = plain.iter().copied().chain(["--samples", "256"]).collect();
    let grainy = read("a.png");
    exits(&folder, &truth, 0);
    let truth = read("a.png");
    let error = |picture: &image::ImageBuffer<image::Luma<f32>, Vec<f32>>| {
        let pairs = picture.pixels().zip(truth.pixels());
        pairs.map(|(a, b)| (a.0[0] - b.0[0]).powi(2)).sum::<f32>()
    };
    assert!(
        error(&clean) < 0.5 * error(&grainy),
        "{} of {}",
        error(&clean),
        error(&grainy)
    );
}
