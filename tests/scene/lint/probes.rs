//! Probes that see nothing of the scene, or that are too many, and maps that are too large or take long.

use std::fs;

use reflet::gpu::{Gpu, GpuOptions};

use super::{folder, found, only};
use crate::common::{
    gpu_or_skip,
    program::{reflet, texts},
};

/// A lit floor with a wall, which is a closed box: 15 lines.
const WALL: &str = include_str!("wall.toml");

/// The wall and a second one, which mirrors: 22 lines; and more text.
fn mirrored(more: &str) -> String {
    [WALL, include_str!("mirror.toml"), more].concat()
}

#[test]
fn a_probe_in_a_wall_is_told_from_one_in_a_room() {
    let probe = format!("{WALL}[probe.hall]\nposition = [3, 1, 0]\n");
    let [name, place, says] = only(&probe);
    assert_eq!((name.as_str(), place.as_str()), ("probe-inside", "16:8"));
    let is_said = says.contains("is inside of \"wall\", which is closed, with nothing else in it");
    assert!(is_said, "{says}");
    let room = probe
        + "[model.room]\nshape = { kind = \"box\", size = [20, 20, 20] }\n[[instance]]\nmodel = \"room\"\n";
    let [_, _, says] = only(&room);
    assert!(says.contains("\"wall\""), "{says}");
    let in_room = found(&room.replace("position = [3, 1, 0]", "position = [0, 1, 0]"));
    assert!(in_room.is_empty(), "the camera stands in it: {in_room:#?}");
}

#[test]
fn a_grid_of_too_many_probes_is_named_where_it_is_written() {
    let grid = mirrored("[reflection]\nmethod = \"probe\"\n[probes]\nspacing_m = 0.01\n");
    let [name, place, says] = only(&grid);
    assert_eq!(
        (name.as_str(), place.as_str()),
        ("too-many-probes", "26:13")
    );
    let parts = ["there is room for 42", "write a `spacing_m` of"];
    assert!(parts.iter().all(|part| says.contains(part)), "{says}");
    // No method looks them up.
    assert!(found(&grid.replace("\"probe\"", "\"rt\"")).is_empty());
}

#[test]
fn methods_whose_maps_hold_nothing_are_named() {
    let moving = WALL.replace("[[instance]]\n", "[[instance]]\ndynamic = true\n");
    for (method, expected) in [
        ("probe", Some("probes see nothing")),
        ("ssr+probe", Some("probes see nothing")),
        ("ssr+box", Some("the faces of the box see nothing")),
        ("near-far", None),
    ] {
        let mut found = found(&format!("{moving}[reflection]\nmethod = \"{method}\"\n"));
        found.retain(|[name, ..]| name == "probes-see-nothing");
        let says = found.first().map(|[_, _, says]| says);
        assert_eq!(says.is_some(), expected.is_some(), "{method}: {says:?}");
        let pairs = says.zip(expected);
        assert!(
            pairs.is_none_or(|(says, part)| says.contains(part)),
            "{method}: {says:?}"
        );
    }
}

/// Exit code and standard error of `render` on a scene text.
fn render(name: &str, text: &str, more: &[&str]) -> (Option<i32>, String) {
    let folder = folder(name);
    fs::write(folder.join("scene.toml"), text).expect("writable");
    let mut command = reflet(&folder, "render scene.toml --size 32x18 -o p.png");
    let output = command.args(more).output().expect("the program starts");
    let [_, errors] = texts(&output);
    assert!(!errors.contains("panicked"), "{errors}");
    (output.status.code(), errors)
}

#[test]
fn check_and_render_refuse_a_setting_at_the_same_place() {
    let options = GpuOptions {
        ray_queries: true,
        ..GpuOptions::default()
    };
    let has_queries = Gpu::new(&options).is_ok_and(|gpu| gpu.has_ray_queries());
    or_skip!(gpu_or_skip());
    for line in include_str!("refused.txt").lines().skip(1) {
        let mut parts = line.splitn(3, ' ');
        let [expected, at, text] = [(); 3].map(|()| parts.next().expect(line));
        let text = text.replace("\\n", "\n");
        if has_queries && expected == "no-ray-queries" {
            continue;
        }
        let text = mirrored(&format!("[reflection]\n{text}"));
        let [name, place, says] = only(&text);
        assert_eq!((name.as_str(), place.as_str()), (expected, at), "{says}");
        let (code, errors) = render(expected, &text, &[]);
        assert_eq!(code, Some(3), "{errors}");
        let parts = [
            &format!("error[{name}]"),
            &format!("scene.toml:{at}"),
            "help: ",
        ];
        assert!(parts.iter().all(|part| errors.contains(part)), "{errors}");
    }
}

/// Thirty-two probes beside a mirror, whose maps take many times as many paths as a picture.
#[test]
fn a_capture_that_takes_long_is_named_where_it_is_written() {
    let slow = mirrored("[reflection]\nmethod = \"probe\"\n[probes]\nspacing_m = 2\n");
    let [name, place, says] = only(&slow);
    assert_eq!((name.as_str(), place.as_str()), ("capture-slow", "26:13"));
    let parts = ["million paths", "write a `face_px` of"];
    assert!(parts.iter().all(|part| says.contains(part)), "{says}");
    let (code, errors) = render("slow", &slow, &["--adapter", "no such adapter"]);
    assert_eq!(code, Some(4), "{errors}");
    let parts = ["warning[capture-slow]", "scene.toml:26:13"];
    assert!(parts.iter().all(|part| errors.contains(part)), "{errors}");
    let small = format!("{slow}face_px = 16\n");
    assert!(found(&small).is_empty());
    assert!(found(&slow.replace("\"probe\"", "\"rt\"")).is_empty());
}
