//! `check` and `info` on scenes with a timeline; neither needs a GPU.

use super::*;

/// Runs a command without an adapter, checks the exit code; returns standard output and standard error.
#[track_caller]
pub fn without_gpu(folder: &Path, arguments: impl Arguments, code: i32) -> [String; 2] {
    let mut command = reflet(folder, arguments);
    ends(command.env("REFLET_ADAPTER", "no such adapter"), code)
}

#[test]
fn check_poses_every_frame_and_info_lists_them() {
    let folder = folder("checked");
    let [out, _] = without_gpu(&folder, "check scene.toml", 0);
    assert_eq!(out, "scene.toml: ok, 6 frames\n");
    let [out, err] = without_gpu(&folder, "info scene.toml", 0);
    for line in [
        "timeline    frames 0 to 5 at 10 fps\n",
        "moves       camera \"main\", light \"lamp\", material \"mirror\", poses of frame() of s.rhai\n",
        "param       lift = 0.5\n",
    ] {
        assert!(out.contains(line), "{line}: {out}{err}");
    }
}

#[test]
fn check_reports_the_first_frame_of_each_mistake() {
    let folder = folder("check-frames");
    let wrong = "fn frame(ctx) {\n    if ctx.frame > 2 { throw \"late\"; }\n    \
                 if ctx.frame == 1 { throw \"one\"; }\n";
    let script = SCRIPT.replace("fn frame(ctx) {\n", wrong);
    fs::write(folder.join("s.rhai"), script).expect("temporary script");
    let [_, err] = without_gpu(&folder, "check scene.toml", 3);
    for says in [
        "late (in frame 3)",
        "s.rhai:2:",
        "one (in frame 1)",
        "s.rhai:3:",
    ] {
        assert_eq!(err.matches(says).count(), 1, "{says}: {err}");
    }
}

#[test]
fn check_shows_what_the_script_prints_in_the_order_of_the_frames() {
    let folder = folder("check-prints");
    let script = SCRIPT.replace(
        "fn frame(ctx) {\n",
        "fn frame(ctx) {\n    print(`at ${ctx.frame}`);\n",
    );
    let script = format!("fn setup(ctx) {{ print(\"once\"); }}\n{script}");
    fs::write(folder.join("s.rhai"), script).expect("temporary script");
    let [_, err] = without_gpu(&folder, "check scene.toml", 0);
    let lines: Vec<_> = err.lines().collect();
    let frames = (0..6).map(|frame| format!("frame {frame}: s.rhai:3: at {frame}"));
    let wanted: Vec<_> = std::iter::once("s.rhai:1: once".to_owned())
        .chain(frames)
        .collect();
    assert_eq!(lines, wanted);
}

/// An exceeded limit may use the whole time budget, so the first one ends the check. Other errors
/// do not.
#[test]
fn check_stops_after_a_script_met_a_limit() {
    let folder = folder("check-limit");
    let said = |frames: &str| {
        let script = format!(
            "fn fill() {{ let s = \"x\"; loop {{ s += s; }} }}\n\
             fn frame(ctx) {{\n    switch ctx.frame {{ {frames} }}\n}}\n"
        );
        fs::write(folder.join("s.rhai"), script).expect("temporary script");
        let [out, err] = without_gpu(&folder, "check scene.toml", 3);
        assert_eq!(out, "", "{err}");
        err
    };
    // Frames are posed in the order 0, 5, 4, 2, 1 and 3.
    let at_first = said("0 => fill(), _ => { throw \"posed\"; }");
    assert_eq!(at_first.matches("error[").count(), 1, "{at_first}");
    assert!(at_first.contains("(in frame 0)"), "{at_first}");
    let between =
        said("5 => { throw \"last\"; }, 2 => fill(), 1 | 3 => { throw \"posed\"; }, _ => ()");
    for says in ["last (in frame 5)", "error[script-limit]", "(in frame 2)"] {
        assert_eq!(between.matches(says).count(), 1, "{says}: {between}");
    }
    assert!(!between.contains("posed (in frame"), "{between}");
    let no_limit = said("0 => { throw \"first\"; }, 3 => { throw \"third\"; }, _ => ()");
    for says in ["first (in frame 0)", "third (in frame 3)"] {
        assert!(no_limit.contains(says), "{says}: {no_limit}");
    }
}

#[test]
fn what_has_no_effect_is_warned_of() {
    let folder = folder("no-effect");
    let cuts = "timeline = { fps = 10, end = 5, cuts = [{ frame = 40, camera = \"main\" }] }";
    let text = super::SCENE.replace("timeline = { fps = 10, end = 5 }", cuts);
    fs::write(folder.join("scene.toml"), text).expect("written");
    let [_, err] = without_gpu(&folder, "check scene.toml", 0);
    assert_says(&err, &["warning[late-cut]", "scene.toml:4:64"]);
    let [_, err] = exits(&folder, "info scene.toml --assets nope --assets .", 0);
    assert_eq!(err.matches("warning[no-folder]").count(), 1, "{err}");
}

#[test]
fn what_a_near_plane_cuts_away_is_told() {
    let folder = folder("cut-away");
    let ball = |z: f32| format!("[[instance]]\nmodel = \"ball\"\ntranslation = [0, 0, {z}]\n");
    let scene = |near: &str| {
        format!(
            "version = 1\n[environment]\ncolor = [1, 1, 1]\n[camera.main]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n{near}\
             [model.ball]\nshape = {{ kind = \"sphere\" }}\n{}{}",
            ball(0.0),
            ball(3.0)
        )
    };
    for (near, is_told) in [
        ("near_m = 4\n", true),
        ("near_m = 0.5\n", false),
        ("", false),
    ] {
        fs::write(folder.join("near.toml"), scene(near)).expect("written");
        let [_, err] = without_gpu(&folder, "check near.toml", 0);
        let told = err.contains("cut-view")
            && err.contains("near.toml:4:9")
            && err.contains("`near_m = 0.1`");
        assert_eq!(told, is_told, "{near}: {err}");
    }
}

#[test]
fn text_of_files_does_not_control_the_terminal() {
    let folder = folder("terminal-text");
    let camera =
        "[camera.\"a\\u001b]0;pwn\\u0007\\u009b2J\"]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n";
    let text = format!("{}{camera}", super::SCENE);
    fs::write(folder.join("scene.toml"), text).expect("written");
    let script = "fn setup(ctx) { print(\"\\x1b]0;pwn\\x07\\x1b[2J\\tend\"); #{} }\n\
                  fn frame(ctx) { print(\"\\x1b[1m\"); }\n";
    fs::write(folder.join("s.rhai"), script).expect("written");
    let is_plain = |c: char| !c.is_control() || c == '\n' || c == '\t';
    for (arguments, code) in [
        ("check scene.toml", 0),
        ("info scene.toml", 0),
        ("info scene.toml --json", 0),
        ("render scene.toml -o f.#.png --camera none", 2),
        ("render scene.toml -o f.#.png --camera all", 2),
    ] {
        let [out, err] = without_gpu(&folder, arguments, code);
        let said = format!("{out}{err}");
        assert!(said.contains("pwn"), "{arguments:?}: {said:?}");
        let raw: Vec<char> = said.chars().filter(|c| !is_plain(*c)).collect();
        assert!(raw.is_empty(), "{arguments:?}: {said:?}");
        if arguments.ends_with("--json") {
            let info: serde_json::Value = serde_json::from_str(&out).expect("JSON");
            let names = info["cameras"].as_array().expect("names");
            assert!(
                names
                    .iter()
                    .any(|name| name == "a\u{1b}]0;pwn\u{7}\u{9b}2J")
            );
        }
    }
}
