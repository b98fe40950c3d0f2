//! Probes that see nothing of the scene, or that are too many, and maps that are too large or take long.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

use reflet::gpu::{Gpu, GpuOptions};

use super::{folder, place, results};
use crate::common::gpu_or_skip;

/// A lit floor with a wall, which is a closed box.
const WALL: &str = "version = 1\n[environment]\ncolor = [1, 1, 1]\n[camera.main]\neye = [0, 2, 6]\ntarget = [0, 0.5, 0]\n\
    [model.floor]\nshape = { kind = \"plane\", size = [8, 8] }\n\
    [model.wall]\nshape = { kind = \"box\", size = [0.2, 4, 4] }\n\
    [[instance]]\nmodel = \"floor\"\n[[instance]]\nmodel = \"wall\"\ntranslation = [3, 1, 0]\n";

/// A second wall, which mirrors: seven lines.
const MIRROR: &str = "[material.mirror]\nmetallic = 1\nroughness = 0\n[[instance]]\nmodel = \"wall\"\n\
    material = \"mirror\"\ntranslation = [-3, 1, 0]\n";

/// Name, place, message and advice of what `check` finds, with this exit code.
fn found(name: &str, more: &str, code: i32) -> Vec<[String; 3]> {
    let folder = folder(name);
    fs::write(folder.join("scene.toml"), format!("{WALL}{more}")).expect("writable");
    let found = results(&folder, &["scene.toml".to_owned()], code);
    let rows = found.iter().map(|found| {
        let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
        [
            text(&found["ruleId"]),
            place(found).0,
            text(&found["message"]["text"]),
        ]
    });
    rows.collect()
}

#[test]
fn a_probe_in_a_wall_is_told_from_one_in_a_room() {
    let probe = "[probe.hall]\nposition = [3, 1, 0]\n";
    let in_wall = found("in-wall", probe, 0);
    let [[name, place, says]] = &in_wall[..] else {
        panic!("{in_wall:#?}")
    };
    assert_eq!((name.as_str(), place.as_str()), ("probe-inside", "16:8"));
    assert!(
        says.contains("is inside of \"wall\", which is closed, with nothing else in it"),
        "{says}"
    );
    let room = format!(
        "{probe}[model.room]\nshape = {{ kind = \"box\", size = [20, 20, 20] }}\n[[instance]]\nmodel = \"room\"\n"
    );
    let both = found("in-wall-in-room", &room, 0);
    assert!(
        both.len() == 1 && both[0][2].contains("\"wall\""),
        "{both:#?}"
    );
    let in_room = found("in-room", &room.replace("[3, 1, 0]", "[0, 1, 0]"), 0);
    assert!(in_room.is_empty(), "the camera stands in it: {in_room:#?}");
}

#[test]
fn a_grid_of_too_many_probes_is_named_where_it_is_written() {
    let grid = format!("{MIRROR}[reflection]\nmethod = \"probe\"\n[probes]\nspacing_m = 0.01\n");
    let refused = found("grid", &grid, 3);
    let [[name, place, says]] = &refused[..] else {
        panic!("{refused:#?}")
    };
    assert_eq!(
        (name.as_str(), place.as_str()),
        ("too-many-probes", "26:13")
    );
    assert!(
        says.contains("there is room for 42") && says.contains("write a `spacing_m` of"),
        "{says}"
    );
    // No method looks them up.
    assert!(found("grid-unused", &grid.replace("\"probe\"", "\"rt\""), 0).is_empty());
}

#[test]
fn methods_whose_maps_hold_nothing_are_named() {
    let moving = WALL.replace("[[instance]]\n", "[[instance]]\ndynamic = true\n");
    for (method, says) in [
        ("probe", Some("probes see nothing")),
        ("ssr+probe", Some("probes see nothing")),
        ("ssr+box", Some("the faces of the box see nothing")),
        ("near-far", None),
    ] {
        let folder = folder(&format!("moving-{method}"));
        let text = format!("{moving}[reflection]\nmethod = \"{method}\"\n");
        fs::write(folder.join("scene.toml"), text).expect("writable");
        let found = results(&folder, &["scene.toml".to_owned()], 0);
        let named = |found: &&serde_json::Value| found["ruleId"] == "probes-see-nothing";
        let message = found.iter().find(named);
        let message = message.map(|found| found["message"]["text"].as_str().unwrap_or_default());
        assert_eq!(message.is_some(), says.is_some(), "{method}: {found:#?}");
        let is_said = message
            .zip(says)
            .is_none_or(|(found, says)| found.contains(says));
        assert!(is_said, "{method}: {message:?}");
    }
}

/// Exit code and standard error of `render` on the scene of a folder.
fn render(folder: &Path, more: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_reflet"))
        .current_dir(folder)
        .args(["render", "scene.toml", "--size", "32x18", "-o", "p.png"])
        .args(more)
        .env("NODEVICE_SELECT", "1") // Mesa's layer writes to standard error without a desktop
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!errors.contains("panicked"), "{errors}");
    (output.status.code(), errors)
}

/// Settings with the name and place of the error that `check` and `render` both give.
const REFUSED: [(&str, &str, &str); 4] = [
    (
        "method = \"probe\"\n[probes]\nspacing_m = 0.01\n",
        "too-many-probes",
        "26:13",
    ),
    (
        "method = \"ssr+probe\"\n[probes]\nface_px = 2048\nspacing_m = 2\n",
        "probe-maps-too-large",
        "26:11",
    ),
    (
        "method = \"ssr+box\"\n[box_faces]\nface_px = 16384\n",
        "box-faces-too-large",
        "26:11",
    ),
    (
        "method = \"rt\"\ntrace = \"query\"\n",
        "no-ray-queries",
        "25:9",
    ),
];

#[test]
fn check_and_render_refuse_a_setting_at_the_same_place() {
    let options = GpuOptions {
        ray_queries: true,
        ..GpuOptions::default()
    };
    let has_queries = Gpu::new(&options).is_ok_and(|gpu| gpu.has_ray_queries());
    if gpu_or_skip().is_none() {
        return;
    }
    for (text, name, at) in REFUSED {
        if has_queries && name == "no-ray-queries" {
            continue;
        }
        let checked = found(name, &format!("{MIRROR}[reflection]\n{text}"), 3);
        let [[of_check, place, says]] = &checked[..] else {
            panic!("{checked:#?}")
        };
        assert_eq!((of_check.as_str(), place.as_str()), (name, at), "{says}");
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("mistakes-{name}"));
        let (code, errors) = render(&folder, &[]);
        assert_eq!(code, Some(3), "{errors}");
        let place = format!("scene.toml:{at}");
        assert!(errors.contains(&format!("error[{name}]")), "{errors}");
        assert!(
            errors.contains(&place) && errors.contains("help: "),
            "{errors}"
        );
    }
}

/// Thirty-two probes beside a mirror, whose maps take many times as many paths as a picture.
#[test]
fn a_capture_that_takes_long_is_named_where_it_is_written() {
    let slow = format!("{MIRROR}[reflection]\nmethod = \"probe\"\n[probes]\nspacing_m = 2\n");
    let warned = found("slow", &slow, 0);
    let [[name, place, says]] = &warned[..] else {
        panic!("{warned:#?}")
    };
    assert_eq!((name.as_str(), place.as_str()), ("capture-slow", "26:13"));
    assert!(
        says.contains("million paths") && says.contains("write a `face_px` of"),
        "{says}"
    );
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mistakes-slow");
    let (code, errors) = render(&folder, &["--adapter", "no such adapter"]);
    assert_eq!(code, Some(4), "{errors}");
    assert!(
        errors.contains("warning[capture-slow]") && errors.contains("scene.toml:26:13"),
        "{errors}"
    );
    let small = format!("{slow}face_px = 16\n");
    assert!(found("slow-small", &small, 0).is_empty());
    let unused = slow.replace("\"probe\"", "\"rt\"");
    assert!(found("slow-unused", &unused, 0).is_empty());
}
