//! Command line: exit codes, messages, and atomic output files.

#[cfg(unix)]
mod agent;
mod cache;
mod crop;
mod denoise;
mod info;
mod lsp;
mod messages;
mod project;
mod sessions;
mod sheet;
mod statistics;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Stdio,
};

use crate::common::{
    folder::{kept_folder, names},
    gpu_or_skip,
    program::{ends, exits, reflet, texts},
    words,
};

/// A scene with a mirror, small enough for any machine.
const SCENE: &str = include_str!("scene.toml");

/// A temporary folder with the scene.
fn folder(name: &str) -> PathBuf {
    kept_folder(&format!("cli-{name}"), &[("scene.toml", SCENE)])
}

#[test]
fn help_and_version_succeed() {
    let folder = folder("help");
    assert!(exits(&folder, "--help", 0)[0].contains("render"));
    assert!(exits(&folder, "--version", 0)[0].contains(env!("CARGO_PKG_VERSION")));
    assert!(exits(&folder, "render --help", 0)[0].contains("REFLET_ADAPTER"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_preview_without_a_display_says_what_to_do() {
    let folder = folder("display");
    let mut command = reflet(&folder, ["preview", "scene.toml"]);
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let [_, text] = texts(&command.output().expect("it starts"));
    let says = "error: there is no display: set DISPLAY or WAYLAND_DISPLAY, or use `reflet render`";
    assert!(text.starts_with(says), "{text}");
}

#[test]
fn check_and_info_need_no_gpu() {
    let folder = folder("no-gpu");
    // No adapter matches: a command that uses the GPU would fail.
    let without_gpu = |arguments: &str| {
        let mut command = reflet(&folder, arguments);
        let [out, _] = ends(command.env("REFLET_ADAPTER", "no such adapter"), 0);
        out
    };
    assert_eq!(without_gpu("check scene.toml"), "scene.toml: ok\n");
    let text = without_gpu("info scene.toml");
    assert!(text.contains("instances   2, 0 dynamic"), "{text}");
    assert!(without_gpu("info").contains("the built-in atrium"));
    let json = without_gpu("info scene.toml --json");
    let info: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(info["instances"], 2);
    assert_eq!(info["lights"], serde_json::json!([0, 0, 1, 0, 0]));
    // The floor's diagonal with the ball on it: sqrt(4² + 4² + 1.2²) / 16.
    let unit_m = info["unit_m"].as_f64().expect("a number");
    assert!((unit_m - f64::sqrt(33.44) / 16.0).abs() < 1e-6, "{unit_m}");
}

#[test]
fn a_picture_is_written_with_its_aovs_and_statistics() {
    or_skip!(gpu_or_skip());
    let folder = folder("picture");
    let render = "render scene.toml --size 33x17 --set reflection.method=hybrid \
                  --set image.visibility=raster --aov source,depth";
    let counted = format!("{render} -o a.png --stats json --counters");
    let [out, error] = exits(&folder, counted, 0);
    assert!(error.contains("wrote a.png"), "{error}");
    let stats: serde_json::Value =
        serde_json::from_str(&out).expect("JSON alone on standard output");
    assert_eq!(stats["size"], serde_json::json!([33, 17]));
    let shares = stats["shares"]["sources"].as_array().expect("a list");
    let sum: f64 = shares
        .iter()
        .filter_map(|share| share["percent"].as_f64())
        .sum();
    assert!((sum - 100.0).abs() < 1e-9, "{shares:?}");
    let passes: Vec<&str> = (stats["counts"].as_array().into_iter().flatten())
        .filter_map(|counts| counts["pass"].as_str())
        .collect();
    assert_eq!(passes, ["light", "ssr", "trace"]);
    assert!(
        stats["counts"][1]["march_steps"].as_u64() > Some(0),
        "{out}"
    );
    let [_, error] = exits(&folder, "render -o c.png --counters", 2);
    assert!(error.contains("--stats"), "{error}");
    let size = image::image_dimensions(folder.join("a.png")).expect("a PNG");
    assert_eq!(size, (33, 17));

    let other = "-o b.exr --method rt --samples 2 --camera top --stats text";
    let [out, _] = exits(&folder, format!("{render} {other}"), 0);
    assert!(
        out.contains("reflective") && out.contains("samples 2") && !out.contains("counted"),
        "{out}"
    );
    let exr = exr::prelude::read_first_flat_layer_from_file(folder.join("b.exr")).expect("an EXR");
    let channels = exr.layer_data.channel_data.list.iter();
    let channels: Vec<String> = channels.map(|channel| channel.name.to_string()).collect();
    assert_eq!(channels, ["A", "B", "G", "R", "depth.Z", "source.source"]);
    assert_eq!(
        names(&folder),
        [
            "a.depth.png",
            "a.png",
            "a.source.png",
            "b.exr",
            "scene.toml"
        ]
    );
}

#[test]
fn one_pixel_and_a_broken_shader_of_ones_own() {
    or_skip!(gpu_or_skip());
    let folder = folder("edges");
    exits(&folder, "render scene.toml -o a.png --size 1x1", 0);
    let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    fs::create_dir_all(folder.join("own/lib")).expect("folder");
    for below in ["", "lib"] {
        for entry in fs::read_dir(shaders.join(below)).expect("shaders") {
            let path = entry.expect("entry").path();
            if path.is_file() {
                let copy = folder
                    .join("own")
                    .join(below)
                    .join(path.file_name().expect("named"));
                fs::copy(&path, copy).expect("copied");
            }
        }
    }
    let render = "render scene.toml --size 8x8 --shaders own";
    exits(&folder, format!("{render} -o b.png"), 0);
    let tone = folder.join("own/tone.wgsl");
    let text = fs::read_to_string(&tone).expect("copied");
    let broken = format!("// first line\nconst broken: u32 = 1.5;\n{text}");
    fs::write(&tone, broken).expect("written");
    let [_, error] = exits(&folder, format!("{render} -o c.png"), 2);
    assert!(error.contains("tone.wgsl:2:"), "{error}");
    assert!(!folder.join("c.png").exists());
}

#[test]
fn comparing_a_picture_with_itself_passes_and_a_crossed_threshold_exits_with_6() {
    let folder = folder("compare");
    for (name, value) in [("a.png", 10_u8), ("b.png", 240)] {
        let picture = image::RgbImage::from_pixel(32, 32, image::Rgb([value; 3]));
        picture.save(folder.join(name)).expect("temporary picture");
    }
    exits(&folder, "compare a.png a.png --max-flip 0.01", 0);
    let [out, _] = exits(&folder, "compare a.png b.png --max-flip 0.01", 6);
    assert!(out.contains("FAILED"), "{out}");
    let [_, error] = exits(&folder, "compare a.png gone.png", 2);
    assert!(error.contains("gone.png"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_reader_that_leaves_early_is_no_error() {
    use std::io::Read as _;
    let folder = folder("pipe");
    let mut child = reflet(&folder, ["info", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let status = child.wait().expect("ends");
    let mut error = String::new();
    let stderr = child.stderr.as_mut().expect("piped");
    stderr.read_to_string(&mut error).expect("UTF-8");
    assert_eq!(status.code(), Some(0), "{error}");
}
