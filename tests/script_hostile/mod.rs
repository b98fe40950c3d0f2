//! Hostile and runaway scripts: each is ended by a limit or refused with a message, and memory
//! stays bounded.

mod limits;
mod meshes;
mod parsing;
mod values;

use std::{fs, path::Path, time::Duration};

use reflet::scene::{
    script::{Bounds, Script},
    stages::{Animator, Scene},
};

use crate::common::{cases, first_or_all, sampled};

const SCENE: &str = include_str!("scene.toml");

/// Bodies of `frame`, each with text that the message must contain.
const FRAMES: &str = include_str!("frames.txt");

const HELPERS: &str = include_str!("helpers.rhai");

fn desc() -> Scene {
    let read = Scene::from_text(SCENE, Path::new("scene.toml"), &[]);
    read.expect("the scene is right").0
}

/// Largest memory of this process so far, MiB.
#[cfg(target_os = "linux")]
fn peak_mib() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux has it");
    let line = status
        .lines()
        .find(|l| l.starts_with("VmHWM"))
        .expect("it has the peak");
    let kib = line.split_whitespace().nth(1).expect("a number");
    kib.parse::<u64>().expect("a number") / 1024
}

/// Runs a body; returns the deviation from the expected end. Bodies that only the limit of time or operations ends
/// get less of both, since they would not end by themselves.
fn run((body, says): &(&str, &str)) -> Option<String> {
    let text = format!("{HELPERS}\nfn frame(ctx) {{\n{body}\n}}");
    let end = || match Script::from_text("hostile.rhai", &text) {
        Err(error) => error.to_string(),
        Ok(script) => {
            let scene = Scene::new(desc().desc, script);
            match Animator::new(&scene).pose(3) {
                Err(errors) => errors[0].to_string(),
                Ok(_) => "nothing was wrong".to_owned(),
            }
        }
    };
    let bounds = match *says {
        "was stopped" => (Bounds::CALL.at_most(100_000)).within(Duration::from_millis(100)),
        says if says.contains("100,000 operations") => Bounds::CALL.at_most(100_000),
        // A body that fills memory or exceeds another limit gets the full bounds, to reach that limit.
        _ => Bounds::CALL,
    };
    let message = bounds.over(end);
    let told = message.to_lowercase().contains(&says.to_lowercase());
    let right = told && message.contains("hostile.rhai:");
    (!right).then(|| format!("{body} should say {says:?}:\n{message}"))
}

/// Deviations of the bodies of a text from their expected ends.
fn wrong_ends(bodies: &'static str) -> Vec<String> {
    cases(bodies).iter().filter_map(run).collect()
}

#[test]
fn every_hostile_frame_is_ended_with_a_message() {
    let frames = cases(FRAMES);
    assert!(frames.len() >= 50);
    let frames = sampled(frames, 3);
    let (some, others) = frames.split_at(frames.len() / 3);
    let wrong = std::thread::scope(|scope| {
        let other = scope.spawn(|| others.iter().filter_map(run).collect::<Vec<_>>());
        let mut wrong: Vec<_> = some.iter().filter_map(run).collect();
        wrong.extend(other.join().expect("no panic"));
        wrong
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n---\n"));
    #[cfg(target_os = "linux")]
    // Two at a time, each within 1,024 MiB when last checked; one step can double that.
    assert!(peak_mib() < 4608, "{} MiB", peak_mib());
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("script-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("scene/parts")).expect("temporary folder");
    folder.join("scene")
}

fn load(folder: &Path, script: &str) -> Result<Scene, String> {
    fs::write(folder.join("s.rhai"), script).expect("temporary file");
    let text = SCENE.replacen("version = 1", "version = 1\nscript = \"s.rhai\"", 1);
    let read = Scene::from_text(&text, &folder.join("scene.toml"), &[]);
    read.map(|(desc, _)| desc).map_err(|errors| {
        let texts: Vec<_> = errors.iter().map(ToString::to_string).collect();
        texts.join("\n")
    })
}

#[test]
fn imports_stay_below_the_folder_of_the_scene() {
    let folder = folder("imports");
    fs::write(folder.join("parts/legs.rhai"), "fn twice(x) { x * 2 }").expect("temporary file");
    fs::write(folder.join("../out.rhai"), "fn f() { }").expect("temporary file");
    fs::write(
        folder.join("parts/loop.rhai"),
        "import \"parts/loop\" as l;",
    )
    .expect("file");
    fs::write(folder.join("parts/bad.rhai"), "fn f( {").expect("temporary file");
    let good = "import \"parts/legs\" as legs;\nfn frame(ctx) { ctx.place(\"ball\", [legs::twice(2), 0, 0]) }";
    let desc = load(&folder, good).expect("it is below");
    let state = Animator::new(&desc).pose(0).expect("it runs");
    assert_eq!(state.instances[0].translation.x, 4.0);
    assert_eq!(desc.script.as_ref().map(|s| s.files.len()), Some(2));
    for (import, says) in [
        ("../out", "not below the scene's folder"),
        ("/etc/passwd", "not below the scene's folder"),
        ("parts/../../out", "not below the scene's folder"),
        ("parts/none", "does not exist"),
        ("parts/loop", "imports itself"),
        ("parts/bad", "bad.rhai:1:"),
    ] {
        let script = format!("import \"{import}\" as m;\nfn frame(ctx) {{ }}");
        let error = load(&folder, &script).expect_err(import);
        assert!(error.contains(says), "{import}: {error}");
    }
    #[cfg(unix)]
    {
        let link = folder.join("parts/link.rhai");
        std::os::unix::fs::symlink(folder.join("../out.rhai"), link).expect("a link");
        let script = "import \"parts/link\" as m;\nfn frame(ctx) { }";
        let error = load(&folder, script).expect_err("it leads out");
        assert!(error.contains("outside the scene's folder"), "{error}");
    }
}

#[test]
fn what_setup_returns_is_checked_as_scene_text() {
    let folder = folder("setup");
    for (returned, says) in cases(include_str!(
        "what_setup_returns_is_checked_as_scene_text.txt"
    )) {
        let script = format!("fn setup(ctx) {{\n{returned}\n}}");
        let error = load(&folder, &script).expect_err(returned);
        assert!(error.contains(says), "{returned}: {error}");
    }
    let script = include_str!("setup.rhai");
    let desc = load(&folder, script).expect("it is right");
    assert_eq!(
        (
            desc.materials.len(),
            desc.lights.len(),
            desc.instances.len()
        ),
        (2, 2, 3)
    );
}

#[test]
fn script_without_functions_is_an_error() {
    let folder = folder("empty");
    for (script, says) in [
        ("", "neither `fn setup(ctx)` nor"),
        ("fn frame() { }", "`frame` has one parameter, `ctx`"),
        ("fn setup(ctx) { #{} }\nfn frame(ctx, t) { }", "s.rhai:2:1"),
        (
            "// fn Frame\nfn setup(ctx) { #{} }\nfn Frame(ctx) { }",
            "did you mean `fn frame`?",
        ),
        ("fn frame(ctx) { }\nfn setup() { }", "`setup` has one"),
        ("fn frame(ctx) {", "s.rhai:1:"),
        ("let x = y;\nfn frame(ctx) { }", "no variable `y`"),
    ] {
        let error = load(&folder, script).expect_err(script);
        assert!(error.contains(says), "{script}: {error}");
    }
}
