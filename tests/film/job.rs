//! Jobs for render farms: a bundle is run task by task, as a farm does, and gives the same frames.

use serde_json::Value;

use super::*;

/// Runs `reflet job` for a system, checks the exit code; returns standard error.
#[track_caller]
fn job(folder: &Path, system: &str, arguments: impl Arguments, code: i32) -> String {
    let mut command = reflet(folder, ["job", system]);
    let [_, error] = ends(command.args(arguments.list()), code);
    error
}

fn read(path: &Path) -> Value {
    let text = fs::read_to_string(path).expect("it is written");
    serde_json::from_str(&text).expect("it is JSON")
}

/// Command of one task of a template with these frames, its parameters replaced by their values.
pub fn task(bundle: &Path, frames: &str) -> Command {
    let template = read(&bundle.join("template.json"));
    let values = read(&bundle.join("parameter_values.json"));
    let action = &template["steps"][0]["script"]["actions"]["onRun"];
    assert_eq!(action["command"], "reflet");
    let argument = |argument: &Value| {
        let mut text = argument.as_str().expect("text").to_owned();
        text = text.replace("{{Task.Param.Frame}}", frames);
        for parameter in values["parameterValues"].as_array().expect("a list") {
            let [name, value] = ["name", "value"].map(|key| parameter[key].as_str().expect("text"));
            text = text.replace(&format!("{{{{Param.{name}}}}}"), value);
        }
        assert!(!text.contains("{{"), "{text}");
        text
    };
    let arguments = action["args"]
        .as_array()
        .expect("a list")
        .iter()
        .map(argument);
    let mut command = reflet(Path::new("."), "");
    command.args(arguments);
    command
}

/// Runs one task to its end; returns its output.
pub fn run_task(bundle: &Path, frames: &str) -> String {
    let [out, _] = ends(&mut task(bundle, frames), 0);
    out
}

#[test]
fn a_bundle_in_chunks_gives_the_frames_of_one_run() {
    let folder = folder("job");
    let bundle = folder.join("bundle");
    let parts = "--pictures parts/f.##.png --chunk 4 --set params.lift=0.7";
    job(
        &folder,
        "openjd",
        format!("scene.toml -o bundle {parts}"),
        0,
    );
    let template = read(&bundle.join("template.json"));
    assert_eq!(template["specificationVersion"], "jobtemplate-2023-09");
    let parameters = template["parameterDefinitions"].as_array().expect("a list");
    let default = |name: &str| {
        let found = parameters.iter().find(|p| p["name"] == name);
        found.expect("it is declared")["default"].clone()
    };
    assert_eq!(
        (default("Frames"), default("FramesPerTask")),
        ("0-5".into(), 4.into())
    );
    let references = read(&bundle.join("asset_references.json"));
    let files = references["assetReferences"]["inputs"]["filenames"].to_string();
    for name in ["scene.toml", "s.rhai", "light.toml"] {
        assert!(files.contains(name), "{files}");
    }
    or_skip!(gpu_or_skip());
    let progress = run_task(&bundle, "0-3");
    assert!(progress.contains("openjd_progress: 25.0\n"), "{progress}");
    assert!(progress.ends_with("f.03.png\n") && progress.contains("openjd_progress: 100.0"));
    run_task(&bundle, "4-5");
    // A task that runs again keeps existing frames.
    assert_eq!(
        run_task(&bundle, "0-3")
            .matches("openjd_status: kept")
            .count(),
        4
    );
    render(&folder, "-o f.##.png --set params.lift=0.7", 0);
    assert_eq!(pictures(&folder.join("parts")), pictures(&folder));
}

/// Words of a text that are options.
fn options(help: &str) -> Vec<&str> {
    let is_part = |c: char| !(c.is_ascii_alphanumeric() || c == '-');
    let words = help.split(is_part).filter(|word| word.starts_with("--"));
    words.collect()
}

#[test]
fn a_job_takes_the_options_of_render() {
    let folder = folder("job-options");
    let help = |command: &[&str]| {
        let [help, _] = exits(&folder, [command, &["--help"]].concat(), 0);
        help
    };
    // These are the job's own, or of one machine.
    let own = words(
        "--output --frames --resume --progress --shard --stats --counters --watch --keep-partial --write-every",
    );
    let of_render = help(&["render"]);
    for system in ["openjd", "slurm"] {
        let of_job = help(&["job", system]);
        let known = options(&of_job);
        for option in options(&of_render)
            .iter()
            .filter(|option| !own.contains(option))
        {
            assert!(known.contains(option), "job {system} has no {option}");
        }
    }
    fs::create_dir(folder.join("own")).expect("written");
    let picture = words(
        "--size 96x54 --method rt --camera=main --samples 2 --aov depth,normal --denoise --adapter -a --lenient",
    );
    let own = words("scene.toml -o bundle --pictures f.#.exr --shaders own");
    let all = [&own[..], &picture[..10], &["--adapter=-a", "--lenient"]].concat();
    job(&folder, "openjd", all, 0);
    let command = format!("{:?}", task(&folder.join("bundle"), "0"));
    for word in picture
        .iter()
        .filter(|word| !["--camera=main", "--adapter", "-a"].contains(word))
    {
        assert!(
            command.contains(&format!("\"{word}\"")),
            "no {word} in {command}"
        );
    }
    let shaders = fs::canonicalize(folder.join("own")).expect("it is there");
    let words = format!("\"--shaders\" \"{}\"", shaders.display());
    assert!(
        command.contains("\"--adapter=-a\"") && command.contains(&words),
        "{command}"
    );
    let references = read(&folder.join("bundle/asset_references.json")).to_string();
    assert!(references.contains("/own\""), "{references}");
    let all = [&own[..], &["--aov", "warmth"]].concat();
    let text = job(&folder, "openjd", all, 2);
    assert!(text.contains("no such AOV"), "{text}");
}

#[test]
fn what_a_farm_cannot_use_is_refused() {
    let folder = folder("job-refused");
    for (arguments, code, says) in [
        ("--pictures f.png", 2, "a file for each frame"),
        ("--pictures f.mp4", 2, "a file for each frame"),
        ("--pictures f.#.avi", 2, "must end in .png"),
        ("--pictures f.#.png --frames 0-9", 2, "not in the timeline"),
        ("--pictures f.#.png --camera no", 2, "no such camera"),
        ("--pictures f.#.png --set params.lift={{x}}", 3, "--set:1"),
        ("--pictures f.#.png --set no.such=1", 3, "unknown-key"),
        ("--pictures {camera}.#.png", 2, "has braces"),
    ] {
        let all = format!("scene.toml -o bundle {arguments}");
        let text = job(&folder, "openjd", all, code);
        assert!(text.contains(says), "{arguments:?}: {text}");
        assert!(!folder.join("bundle").exists(), "nothing is written");
    }
}

/// Runs one task of a script as Slurm does, in a shell of its own.
fn run_array_task(script: &Path, task: usize) -> (bool, String) {
    let program = Path::new(env!("CARGO_BIN_EXE_reflet"));
    let folder = program.parent().expect("a folder");
    let paths = std::env::var("PATH").unwrap_or_default();
    let output = Command::new("bash")
        .arg(script)
        .env("PATH", format!("{}:{paths}", folder.display()))
        .env("SLURM_ARRAY_TASK_ID", task.to_string())
        .env("NODEVICE_SELECT", "1")
        .output()
        .expect("a shell starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.success(), text)
}

#[test]
#[cfg(unix)]
fn an_array_of_slurm_gives_the_frames_of_one_run() {
    let folder = folder("slurm it's");
    let slurm = |arguments: &str, code: i32| {
        let all = format!("scene.toml -o film.sh {arguments}");
        job(&folder, "slurm", all, code)
    };
    let set = "params.lift=0.7";
    slurm("--pictures {camera}.##.png", 2);
    assert!(!folder.join("film.sh").exists(), "nothing is written");
    let text = slurm("--pictures f.png", 2);
    assert!(text.contains("a file for each frame"), "{text}");
    slurm(
        &format!("--pictures parts/f.##.png --chunk 4 --set {set}"),
        0,
    );
    let script = fs::read_to_string(folder.join("film.sh")).expect("it is written");
    assert!(script.starts_with("#!/bin/bash\n"), "{script}");
    for line in [
        "#SBATCH --array=0-1\n",
        "#SBATCH --requeue\n",
        "chunks=( 0-3 4-5 )\n",
    ] {
        assert!(script.contains(line), "{script}");
    }
    or_skip!(gpu_or_skip());
    for task in [0, 1, 0] {
        let (success, text) = run_array_task(&folder.join("film.sh"), task);
        assert!(success, "{text}");
    }
    render(&folder, ["-o", "f.##.png", "--set", set], 0);
    assert_eq!(pictures(&folder.join("parts")), pictures(&folder));
    // A task index that does not exist.
    assert!(!run_array_task(&folder.join("film.sh"), 2).0);
}

#[test]
fn names_in_a_bundle_are_those_that_a_farm_can_use() {
    let folder = folder("job-names");
    let long = format!("bell\u{7}{}.toml", "x".repeat(200));
    let scene = super::SCENE.replace("camera.main", "camera.-x");
    fs::write(folder.join(&long), scene).expect("written");
    let cameras = ["--camera=-x", "--pictures", "f.#.png", "-o"];
    let all = [&[long.as_str()][..], &cameras, &["bundle"]].concat();
    job(&folder, "openjd", all, 0);
    let template = read(&folder.join("bundle/template.json"));
    let name = template["name"].as_str().expect("text");
    assert_eq!(name, format!("bell_{}", "x".repeat(123)));
    let arguments = &template["steps"][0]["script"]["actions"]["onRun"]["args"];
    let arguments = arguments.as_array().expect("a list");
    assert!(
        arguments.iter().any(|a| a == "--camera=-x"),
        "{arguments:?}"
    );
    let bell = ["scene.toml", "-o", "other", "--pictures", "f\u{7}.#.png"];
    let text = job(&folder, "openjd", bell, 2);
    assert!(text.contains("has a control character"), "{text}");
    assert!(!text.contains('\u{7}') && !folder.join("other").exists());
    if gpu_or_skip().is_some() {
        run_task(&folder.join("bundle"), "2");
        assert!(folder.join("f.2.png").is_file());
    }
}
