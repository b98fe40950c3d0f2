//! Several cameras in one run.

use super::*;

/// Several cameras in one run: each picture equals the picture of a run with that camera alone.
#[test]
fn several_cameras_are_written_to_files_with_their_names() {
    let folder = folder("cameras");
    let scene = format!("{SCENE}[camera.side]\neye = [4, 1, 0]\ntarget = [0, 0.5, 0]\n");
    fs::write(folder.join("scene.toml"), scene).expect("writable");
    for (arguments, says) in [
        ("-o f.png --camera all", "write f.{camera}.png"),
        ("-o f.{camera}.png --camera main,sied", "it has: main, side"),
        ("-o f.{camera}.png --camera main,main", "is listed twice"),
        (
            "-o f.{camera}.png --camera all --stats text",
            "applies to a single picture",
        ),
    ] {
        let text = render(&folder, arguments, 2);
        assert!(text.contains(says), "{arguments:?}: {text}");
    }
    let several = ["-o", "f.#.png", "--frames", "1-2", "--stats", "text"];
    let text = render(&folder, several, 2);
    assert!(text.contains("write --frames 1"), "{text}");
    or_skip!(gpu_or_skip());
    render(
        &folder,
        words("-o f.{camera}.#.png --camera all --frames 0-1"),
        0,
    );
    render(&folder, "-o {camera}.png --camera side,main", 0);
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
    render(&folder, "-o alone.png --camera side --frames 1", 0);
    let alone = pixels(&folder.join("alone.png"));
    assert!(alone == pixels(&folder.join("f.side.1.png")), "as alone");
    assert!(
        alone != pixels(&folder.join("f.main.1.png")),
        "the cameras differ"
    );
    let kept = render(
        &folder,
        words("-o f.{camera}.#.png --camera all --frames 0-1 --resume"),
        0,
    );
    assert_eq!(kept.matches(": kept f.").count(), 4, "{kept}");
}

#[test]
fn all_leaves_out_cameras_of_placed_scenes() {
    or_skip!(gpu_or_skip());
    let folder = folder("cameras-placed");
    let placed = "version = 1\n[camera.inside]\n[model.ball]\nshape = { kind = \"sphere\" }\n\
                  [[instance]]\nmodel = \"ball\"\n";
    let own = "version = 1\nimage.size = [16, 9]\n[camera.main]\n[camera.side]\neye = [4, 1, 0]\n\
               [[instance]]\nname = \"room\"\nmodel = { scene = \"placed.toml\" }\n";
    fs::write(folder.join("placed.toml"), placed).expect("writable");
    fs::write(folder.join("scene.toml"), own).expect("writable");
    render(&folder, "-o f.{camera}.png --camera all", 0);
    let there = |name: &str| folder.join(name).exists();
    assert!(there("f.main.png") && there("f.side.png") && !there("f.room.inside.png"));
    let named = ["-o", "f.{camera}.png", "--camera", "room.inside,main"];
    render(&folder, named, 0);
    assert!(there("f.room.inside.png"));
}
