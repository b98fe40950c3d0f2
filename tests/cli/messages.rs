//! Messages on standard error: errors of usage, notes about likely mistakes, and streams that take no message.

use std::{fs, process::Stdio};

use super::{SCENE, exits, folder, names, reflet};
use crate::common::gpu_or_skip;

#[test]
fn usage_errors_exit_with_2_and_say_what_is_wrong() {
    let folder = folder("usage");
    for (arguments, says) in [
        (&["rendr"][..], "unrecognized subcommand"),
        (
            &["scene.toml"],
            "`reflet render scene.toml -o picture.png` renders it",
        ),
        (&["render", "scene.toml"], "--output"),
        (&["render", "-o", "a.png", "--size", "0x4"], "1 to 16384"),
        (&["render", "-o", "a.png", "--size", "big"], "WIDTHxHEIGHT"),
        (&["render", "-o", "a.png", "--samples", "0"], "1..=4096"),
        (&["render", "-o", "a.png", "--method", "rtx"], "hybrid"),
        (&["render", "-o", "a.gif"], "must end in .png or .exr"),
        (
            &["render", "-o", "no/where/a.png"],
            "there is no folder no/where",
        ),
        (
            &["render", "-o", "a.png", "--aov", "depht"],
            "choose from depth, normal",
        ),
        (
            &["render", "-o", "a.png", "--shaders", "none"],
            "cannot read",
        ),
        (
            &["render", "-o", "a.png", "--shaders", "."],
            "no .wgsl files",
        ),
        (
            &["render", "scene.toml", "-o", "a.png", "--camera", "tpo"],
            "it has: main, top",
        ),
    ] {
        let [_, error] = exits(&folder, arguments, 2);
        assert!(error.contains(says), "{arguments:?} says {error}");
    }
    assert_eq!(names(&folder), ["scene.toml"]);
}

#[test]
fn render_names_likely_mistakes_that_check_explains() {
    if gpu_or_skip().is_none() {
        return;
    }
    let folder = folder("hint");
    let lamp = "[light.bulb]\nkind = \"point\"\nposition = [0, 0.7, 0]\nintensity_cd = 3\n";
    fs::write(folder.join("lamp.toml"), format!("{SCENE}{lamp}")).expect("written");
    let size = ["-o", "a.png", "--size", "16x9"];
    let [_, said] = exits(&folder, &[&["render", "lamp.toml"][..], &size].concat(), 0);
    let note = "note: likely mistakes (light-inside): `reflet check lamp.toml` explains them";
    assert!(said.contains(note), "{said}");
    let [_, said] = exits(&folder, &[&["render", "scene.toml"][..], &size].concat(), 0);
    assert_eq!(said, "wrote a.png\n");
}

#[cfg(target_os = "linux")]
#[test]
fn messages_that_cannot_be_written_end_nothing() {
    if gpu_or_skip().is_none() {
        return;
    }
    let folder = folder("stderr");
    let full = || {
        let device = fs::OpenOptions::new().write(true).open("/dev/full");
        device.expect("Linux has this device")
    };
    let film = [
        "render",
        "scene.toml",
        "-o",
        "a.##.png",
        "--size",
        "16x9",
        "--set",
        "timeline.end=1",
    ];
    for (arguments, code) in [
        (&film[..], 0),
        (&["check", "scene.toml", "gone.toml"], 3),
        (&["render"], 2),
    ] {
        let status = reflet(&folder, arguments)
            .stdout(Stdio::null())
            .stderr(full())
            .status();
        let status = status.expect("the program starts");
        assert_eq!(status.code(), Some(code), "{arguments:?}");
    }
    assert_eq!(names(&folder), ["a.00.png", "a.01.png", "scene.toml"]);
}
