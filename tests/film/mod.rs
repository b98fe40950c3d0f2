//! Frame sequences: frames are independent of order, `--resume` keeps only valid files, and failed
//! frames are reported.

mod check_and_info;
#[cfg(unix)]
mod ffmpeg;
mod full_disk;
#[cfg(unix)]
mod interruption;
mod job;
mod outputs;
mod pack;
mod paths;
mod readme;
mod same_bytes;
mod show;
#[cfg(target_os = "linux")]
mod slurm_cluster;

// Names that most tests of films need, beside the imports and functions below.
pub use crate::common::{assert_says, folder::names, program::exits};
pub use std::{process::Stdio, time::Duration};

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::common::{
    cases, first_or_all,
    folder::kept_folder,
    gpu_or_skip,
    program::{Arguments, ends, reflet},
    words,
};
use reflet::{
    scene::stages::{Animator, Scene},
    world::load::{self, LoadOptions},
};

const SCENE: &str = include_str!("scene.toml");

const LIGHT: &str = include_str!("light.toml");

const SCRIPT: &str = "fn frame(ctx) {
    ctx.place(\"ball\", [0, ctx.params.lift + 0.2 * ctx.frame, 0]);
    if ctx.frame % 2 == 1 { ctx.material(\"red\", #{ roughness: 0.1 }); }
}";

fn folder(name: &str) -> PathBuf {
    kept_folder(
        &format!("film-{name}"),
        &[
            ("scene.toml", SCENE),
            ("s.rhai", SCRIPT),
            ("light.toml", LIGHT),
        ],
    )
}

/// The command `reflet render scene.toml`.
fn rendering(folder: &Path, arguments: impl Arguments) -> Command {
    let mut command = reflet(folder, "render scene.toml");
    command.args(arguments.list());
    command
}

/// Runs `reflet render scene.toml`, checks the exit code, returns standard error.
#[track_caller]
fn render(folder: &Path, arguments: impl Arguments, code: i32) -> String {
    let [_, error] = ends(&mut rendering(folder, arguments), code);
    error
}

fn pictures(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(folder)
        .expect("readable")
        .map(|e| e.expect("entry").path());
    let is_picture = |p: &PathBuf| p.extension().is_some_and(|e| e == "png" || e == "exr");
    let named = |path: PathBuf| {
        let name = path.file_name().expect("a name").to_string_lossy();
        (name.into_owned(), fs::read(&path).expect("readable"))
    };
    files.filter(is_picture).map(named).collect()
}

#[test]
fn order_and_shards_do_not_change_a_byte() {
    or_skip!(gpu_or_skip());
    let whole = folder("whole");
    let text = render(&whole, "-o f.###.png --frames all", 0);
    assert!(text.contains("frame 5 (6 of 6): wrote f.005.png"), "{text}");
    let whole = pictures(&whole);
    assert_eq!(whole.len(), 6);
    let shuffled = folder("shuffled");
    render(&shuffled, "-o f.###.png --frames 4,0,5,2-3,1", 0);
    assert_eq!(pictures(&shuffled), whole, "another order");
    let shards = folder("shards");
    for shard in ["2/2", "1/2"] {
        render(&shards, ["-o", "f.###.png", "--shard", shard], 0);
    }
    assert_eq!(pictures(&shards), whole, "two shards");
    let alone = folder("alone");
    let third = "-o f.003.png --frames 3 --stats json --counters";
    let [third, _] = ends(&mut rendering(&alone, third), 0);
    let stats: serde_json::Value = serde_json::from_str(&third).expect("JSON alone");
    assert!(stats["counts"].is_array(), "{stats}");
    assert!(stats["frame_ms"].as_f64() > Some(0.0), "{stats}");
    // One frame per run, as a farm does; the file name has another program's frame notation.
    render(&alone, "-o f.%03d.png --frames 5", 0);
    let alone = pictures(&alone);
    assert_eq!(alone.len(), 2, "{:?}", alone.keys());
    assert!(alone.iter().all(|(name, bytes)| *bytes == whole[name]));
    let distinct: std::collections::BTreeSet<_> = whole.values().collect();
    assert_eq!(distinct.len(), 6, "something moves in every frame");
}

#[test]
fn resuming_keeps_what_is_the_same_and_renders_the_rest() {
    or_skip!(gpu_or_skip());
    let folder = folder("resume");
    let frames = [
        "-o", "f.#.png", "--frames", "0-2", "--aov", "depth", "--resume",
    ];
    render(&folder, frames, 0);
    let first = pictures(&folder);
    assert_eq!(first.len(), 6);
    assert_eq!(render(&folder, frames, 0).matches(": kept f.").count(), 3);
    let progress = [&frames[..], &["--progress", "json"]].concat();
    assert_eq!(render(&folder, &progress, 0).matches("kept").count(), 0);
    // A missing frame, a truncated one, and a missing plane.
    fs::remove_file(folder.join("f.0.png")).expect("it is there");
    let bytes = fs::read(folder.join("f.1.png")).expect("it is there");
    fs::write(folder.join("f.1.png"), &bytes[..bytes.len() - 20]).expect("writable");
    fs::remove_file(folder.join("f.2.depth.png")).expect("it is there");
    let text = render(&folder, frames, 0);
    assert_eq!(text.matches("wrote").count(), 3, "{text}");
    assert_eq!(pictures(&folder), first);
    // Another parameter, size, script or included light changes all fingerprints.
    for change in [&["--set", "params.lift=0.6"][..], &["--size", "26x16"]] {
        let text = render(&folder, [&frames, change].concat(), 0);
        assert_eq!(text.matches("wrote").count(), 3, "{text}");
    }
    let script = SCRIPT.replace("0.2", "0.21");
    fs::write(folder.join("s.rhai"), script).expect("writable");
    let text = render(&folder, frames, 0);
    assert_eq!(text.matches("wrote").count(), 3, "{text}");
    let light = LIGHT.replace("= 20", "= 21");
    fs::write(folder.join("light.toml"), light).expect("writable");
    let text = render(&folder, frames, 0);
    assert_eq!(text.matches("wrote").count(), 3, "{text}");
    let exr = ["-o", "f.#.exr", "--frames", "0-1", "--resume"];
    render(&folder, exr, 0);
    assert_eq!(render(&folder, exr, 0).matches(": kept f.").count(), 2);
}

fn pixels(file: &Path) -> Vec<u8> {
    image::open(file).expect("a PNG").into_bytes()
}

/// Plan of a film: covers all frames, not only the values at load.
#[test]
fn a_material_that_becomes_a_mirror_shows_what_a_mirror_shows() {
    or_skip!(gpu_or_skip());
    let folder = folder("mirror");
    render(&folder, "-o moved.png --frames 5", 0);
    let key = "[motion.material.mirror]";
    let (before, after) = SCENE.split_once(key).expect("it moves");
    let rest = after
        .split_once("[material.red]")
        .expect("the next table")
        .1;
    let still = format!("{before}[material.red]{rest}").replace("roughness = 0.5", "roughness = 0");
    fs::write(folder.join("scene.toml"), &still).expect("writable");
    render(&folder, "-o mirror.png --frames 5", 0);
    let matte = still.replace("roughness = 0\n", "roughness = 0.5\n");
    fs::write(folder.join("scene.toml"), matte).expect("writable");
    render(&folder, "-o matte.png --frames 5", 0);
    let [moved, mirror, matte] =
        ["moved", "mirror", "matte"].map(|name| pixels(&folder.join(format!("{name}.png"))));
    assert!(moved == mirror, "it is not the mirror that it should be");
    assert!(mirror != matte, "the mirror cannot be seen");
}

#[test]
fn films_in_one_file_decode() {
    or_skip!(gpu_or_skip());
    let folder = folder("apng");
    render(&folder, "-o f.apng", 0);
    let file = fs::File::open(folder.join("f.apng")).expect("it is there");
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let mut reader = decoder.read_info().expect("a PNG");
    let control = reader.info().animation_control.expect("animated");
    assert_eq!((control.num_frames, control.num_plays), (6, 0));
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let mut seen = Vec::new();
    for _ in 0..6 {
        reader.next_frame(&mut pixels).expect("a frame");
        let frame = reader.info().frame_control.expect("its control");
        assert_eq!((frame.delay_num, frame.delay_den), (1, 10));
        seen.push(pixels.clone());
    }
    assert!(seen.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn invalid_options_are_refused() {
    let folder = folder("usage");
    for (arguments, says) in cases(include_str!("invalid_options_are_refused.txt")) {
        let code = if says.starts_with("did") { 3 } else { 2 };
        let text = render(&folder, words(arguments), code);
        assert!(text.contains(says), "{arguments}: {text}");
    }
    fs::write(folder.join("scene.toml"), "version = 1\n").expect("writable");
    let text = render(&folder, "-o f.#.png", 2);
    assert!(text.contains("no [timeline]"), "{text}");
}

/// Poses are independent of earlier frames.
#[test]
fn applying_poses_leaves_no_trace() {
    let folder = folder("trace");
    let (desc, _) = Scene::from_file(&folder.join("scene.toml"), &[]).expect("it is right");
    let world = load::load(&desc, &LoadOptions::default()).expect("it loads");
    let motion = Animator::new(&desc);
    let (mut fresh, mut used) = (world.clone(), world);
    for frame in [1, 3, 5, 0, 2] {
        let state = motion.pose(frame).expect("it moves");
        used.apply(&state).expect("it can be posed");
    }
    fresh
        .apply(&motion.pose(2).expect("it moves"))
        .expect("it can be posed");
    for (a, b) in fresh.instances.iter().zip(&used.instances) {
        assert_eq!(a.world_from_object, b.world_from_object, "{}", a.name);
    }
    assert_eq!(fresh.materials, used.materials);
    assert_eq!(fresh.lights, used.lights);
    let ball = fresh.instances[1].world_from_object.translation;
    assert!((ball.y - 0.9).abs() < 1e-6, "{ball}");
    assert_eq!(fresh.cameras[0].value.target, glam::Vec3::from(ball));
}

#[test]
fn the_films_of_the_project_can_be_posed() {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts");
    let mut films = 0;
    for entry in fs::read_dir(scripts).expect("the folder is there") {
        let path = entry.expect("entry").path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        films += 1;
        let shown = path.display();
        let (desc, warnings) =
            Scene::from_file(&path, &[]).unwrap_or_else(|e| panic!("{shown}: {e:?}"));
        assert_eq!(warnings, [], "{shown}");
        let mut world =
            load::load(&desc, &LoadOptions::default()).unwrap_or_else(|e| panic!("{shown}: {e:?}"));
        let motion = Animator::new(&desc);
        let end = desc.timeline.as_ref().expect("it is a film").end;
        for frame in [0, 1, end / 2, end] {
            let state = motion
                .pose(frame)
                .unwrap_or_else(|e| panic!("{shown}: {e:?}"));
            world
                .apply(&state)
                .unwrap_or_else(|e| panic!("{shown}: {e:?}"));
        }
    }
    assert!(films >= 6, "only {films} films");
}
