//! Several cameras in one run.

use std::fs;

use super::{SCENE, folder, pictures, pixels, render};
use crate::common::gpu_or_skip;

/// Several cameras in one run: each picture equals the one of a run with that camera alone.
#[test]
fn several_cameras_are_written_to_files_with_their_names() {
    let folder = folder("cameras");
    let scene = format!("{SCENE}[camera.side]\neye = [4, 1, 0]\ntarget = [0, 0.5, 0]\n");
    fs::write(folder.join("scene.toml"), scene).expect("writable");
    for (arguments, says) in [
        (
            &["-o", "f.png", "--camera", "all"][..],
            "write f.{camera}.png",
        ),
        (
            &["-o", "f.{camera}.png", "--camera", "main,sied"],
            "it has: main, side",
        ),
        (
            &["-o", "f.{camera}.png", "--camera", "main,main"],
            "is listed twice",
        ),
        (
            &["-o", "f.{camera}.png", "--camera", "all", "--stats", "text"],
            "applies to a single picture",
        ),
    ] {
        let text = render(&folder, arguments, 2);
        assert!(text.contains(says), "{arguments:?}: {text}");
    }
    let several = ["-o", "f.#.png", "--frames", "1-2", "--stats", "text"];
    let text = render(&folder, &several, 2);
    assert!(text.contains("write --frames 1"), "{text}");
    if gpu_or_skip().is_none() {
        return;
    }
    render(
        &folder,
        &[
            "-o",
            "f.{camera}.#.png",
            "--camera",
            "all",
            "--frames",
            "0-1",
        ],
        0,
    );
    render(&folder, &["-o", "{camera}.png", "--camera", "side,main"], 0);
    let all = pictures(&folder);
    let names: Vec<_> = all.keys().map(String::as_str).collect();
    let want = [
        "f.main.0.png",
        "f.main.1.png",
        "f.side.0.png",
        "f.side.1.png",
        "main.png",
        "side.png",
    ];
    assert_eq!(names, want);
    render(
        &folder,
        &["-o", "alone.png", "--camera", "side", "--frames", "1"],
        0,
    );
    let alone = pixels(&folder.join("alone.png"));
    assert!(alone == pixels(&folder.join("f.side.1.png")), "as alone");
    assert!(
        alone != pixels(&folder.join("f.main.1.png")),
        "the cameras differ"
    );
    let kept = render(
        &folder,
        &[
            "-o",
            "f.{camera}.#.png",
            "--camera",
            "all",
            "--frames",
            "0-1",
            "--resume",
        ],
        0,
    );
    assert_eq!(kept.matches(": kept f.").count(), 4, "{kept}");
}
