//! Timeline frames in a bench: posing, measurement order, resuming and invalid ranges.

use super::*;

/// X positions of camera, ball and lamp, at keys.
const AT_FRAME_4: [&str; 3] = ["1", "0.5", "-1"];

const SCRIPT: &str = include_str!("timeline/script.rhai");

const MOVES: &str = include_str!("timeline/moves.toml");

/// A ball over a mirror: x positions of its camera, ball and lamp, and the floor's roughness.
fn scene(moves: &str, [eye, ball, lamp]: [&str; 3], roughness: &str) -> String {
    include_str!("timeline/scene.toml")
        .replace("MOVES", moves)
        .replace("EYE", eye)
        .replace("LAMP", lamp)
        .replace("BALL", ball)
        .replace("ROUGHNESS", roughness)
}

fn write_scenes(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("a file");
    write("move.rhai", SCRIPT);
    write("path.rhai", "fn x(t) { t / 2 }\n");
    write("moves.toml", &scene(MOVES, ["0", "0", "2"], "0"));
    write("stands.toml", &scene("", AT_FRAME_4, "0.125"));
}

/// Arguments for `ssr` and `rt` of a scene, each timed once.
fn run(scene: &str, out: &str, more: &str) -> String {
    let run = "--sizes 64x36 --methods ssr,rt --parameter steps --values 64";
    format!("{scene} {run} --frames 1 --warm-up 1 --counters -o {out} {more}")
}

/// Error metrics and work counters of a sample, without times.
fn seen(sample: &Sample) -> impl PartialEq + std::fmt::Debug + use<> {
    (
        (sample.method.clone(), sample.unit_m, sample.ssim),
        (sample.flip, sample.rel_mse, sample.mask_px),
        (sample.march_steps, sample.visited_nodes, sample.traversals),
        (sample.reflective_px, sample.rays, sample.false_accepts),
    )
}

#[test]
fn frames_of_a_timeline_are_posed_measured_and_resumed() {
    or_skip!(gpu_or_skip());
    let folder = folder("timeline");
    write_scenes(&folder);
    let run_moves = |more: &str| {
        let [_, said] = exits(&folder, run("moves.toml", "out", more), 0);
        said
    };
    let said = run_moves("--timeline 0-4:2");
    assert!(said.contains("Temporal error"), "{said}");
    assert!(said.contains("2 pairs of frames 2 apart"), "{said}");
    assert!(!said.contains("note:"), "{said}");
    let out = folder.join("out");
    let first = samples(&out);
    let frames: Vec<_> = first.iter().map(|s| (s.frame, s.since_frame)).collect();
    let since = [(0, None), (2, Some(0)), (4, Some(2))];
    assert_eq!(frames, since.map(|frame| [frame; 2]).concat());
    for pair in first.windows(3) {
        assert_ne!(seen(&pair[0]), seen(&pair[2]), "frames differ");
    }
    for sample in &first[2..] {
        assert_eq!(sample.status, "ok");
        assert!(sample.update_ms.is_some() && sample.temporal_change > Some(0.0));
    }
    for chart in ["line-chart-1-ms.svg", "line-chart-1-ssim.svg"] {
        let svg = fs::read_to_string(out.join(chart)).expect("a chart");
        assert!(svg.contains("<title>ssr, frame 2: "), "{chart}");
    }

    // Frame 4 equals a static scene with the same values.
    let [_, said] = exits(&folder, run("stands.toml", "still", ""), 0);
    assert!(!said.contains("timeline"), "{said}");
    let still = samples(&folder.join("still"));
    let written: Vec<_> = still.iter().map(seen).collect();
    assert_eq!(first[4..].iter().map(seen).collect::<Vec<_>>(), written);

    // Without a list the first frame is posed, and it is said.
    let at_4 = run("moves.toml", "one", "--set timeline.start=4");
    let [_, said] = exits(&folder, at_4, 0);
    let note = "of the frames 4 to 7 of its timeline only 4 is measured";
    assert_eq!(said.matches(note).count(), 1, "{said}");
    let one = samples(&folder.join("one"));
    assert!(one.iter().all(|s| s.frame == 4 && s.update_ms.is_none()));
    assert_eq!(one.iter().map(seen).collect::<Vec<_>>(), written);

    let said = run_moves("--timeline 0,2-4 --resume");
    assert!(said.contains("6 frames were measured before"), "{said}");
    let second = samples(&out);
    assert_eq!((second.len(), &second[..6]), (8, &first[..]));
    // Imports of the script are part of the fingerprint.
    fs::write(folder.join("path.rhai"), "fn x(t) { t / 4 }\n").expect("a file");
    let said = run_moves("--timeline 0 --resume");
    assert!(!said.contains("measured before"), "{said}");
    let third = samples(&out);
    assert_eq!(third.len(), 10);
    assert_ne!(third[9].content, first[0].content);
}

#[test]
fn frames_that_are_not_there_are_refused_before_anything_is_measured() {
    let folder = folder("bad-frames");
    write_scenes(&folder);
    for (scene, more, code, says) in [
        (
            "moves.toml",
            "--timeline 5-9",
            2,
            "--timeline 5-9: frame 9 is not in the timeline, which has 0 to 7",
        ),
        ("moves.toml", "--timeline x", 2, "--timeline x: "),
        (
            "stands.toml",
            "--timeline 0-3",
            2,
            "stands.toml has no [timeline]",
        ),
        (
            "moves.toml",
            "--timeline 0-4 --set params.breaks=3",
            3,
            "in frame 3",
        ),
        ("moves.toml", "--set params.breaks=0", 3, "in frame 0"),
    ] {
        let [_, error] = exits(&folder, run(scene, "bad", more), code);
        assert!(error.contains(says), "{more:?} says {error}");
        assert!(!folder.join("bad").exists(), "{more:?}");
    }
}
