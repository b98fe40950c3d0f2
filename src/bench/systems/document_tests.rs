//! Tests of the document of systems.

use super::{
    super::{Row, SYSTEMS, Side, frames::FrameRow, overall::best},
    *,
};

#[test]
fn what_rivals_do_better_is_said_first() {
    let row = |system: &super::super::System| Row {
        system: system.name,
        ms: if system.name.starts_with("probe") {
            1.0
        } else {
            2.0
        },
        errors: Some(SystemErrors {
            flip: if system.side == Side::Own { 0.01 } else { 0.2 },
            ..SystemErrors::default()
        }),
        ..Row::default()
    };
    let refused = |system: &super::super::System| LeftOut {
        system: system.name,
        why: "The hall has no door".to_owned(),
    };
    let scene = SceneRows {
        scene: "hall.toml".to_owned(),
        size: [640, 360],
        frames: 1,
        scored_px: vec![500],
        probes: 3,
        rows: SYSTEMS.iter().skip(1).map(row).collect(),
        left_out: [&SYSTEMS[0], &SYSTEMS[1]].map(refused).to_vec(),
    };
    let about = Conditions {
        command: "reflet bench comparators".to_owned(),
        adapter: "a chip".to_owned(),
        size: [64, 36],
        frames: 3,
        is_processor: false,
        threads: Some("1".to_owned()),
        enough_px: 1000,
        most_doublings: 2,
    };
    let scenes = [scene];
    let best = best(&scenes, 2);
    let failures = [Failure {
        system: "near-far",
        scene: "hole.toml".to_owned(),
        text: "It is black.",
        address: "hole.png".to_owned(),
    }];
    let text = document(
        &about,
        &scenes,
        (&best, "best.svg"),
        (&failures, &[]),
        |_, ending| format!("chart{ending}.svg"),
    );
    let first = text.find("## What rivals do better").expect("a heading");
    let said = text
        .find("- probe, box, K = 1: less time")
        .expect("a sentence");
    assert!(
        first < said && said < text.find("## hall.toml").expect("a scene"),
        "{text}"
    );
    assert!(text.contains("| hybrid | 1.00 | 0.0100 |"), "{text}");
    assert!(
        text.contains("64 × 36 pixels on a chip with one thread, 4 times as wide"),
        "{text}"
    );
    let scored = "one picture of 640 × 360 pixels, 500 reflective pixels scored, 3 probes.";
    assert!(text.contains(scored), "{text}");
    assert!(
        text.contains("![near-far beside rt](hole.png) | It is black."),
        "{text}"
    );
    assert!(
        !text.contains("- ssr, 2 layers:"),
        "it is neither faster nor better: {text}"
    );
    assert!(!text.contains("| ssr |"), "it was not measured: {text}");
    assert!(!text.contains("chart-ms.svg"), "it is a still: {text}");
    let why = "Not measured: ssr; probe, infinity, K = 1. The hall has no door.";
    assert!(text.contains(why), "{text}");
}

#[test]
fn films_have_curves_and_what_is_made_anew() {
    let frame = |frame| FrameRow {
        frame,
        ms: 2.0,
        update_ms: 7.0,
        errors: Some(SystemErrors::default()),
    };
    let mut film = SceneRows {
        scene: "film.toml".to_owned(),
        size: [64, 36],
        frames: 3,
        scored_px: vec![500, 157],
        probes: 0,
        rows: vec![Row {
            system: "near-far",
            popping: Some(0.5),
            update_ms: 7.0,
            errors: Some(SystemErrors::default()),
            frames: [0, 1].map(frame).to_vec(),
            ..Row::default()
        }],
        left_out: Vec::new(),
    };
    let mut text = String::new();
    section(&mut text, &film, |ending| format!("chart{ending}.svg"));
    for part in [
        "3 frames of 64 × 36 pixels, 2 of them scored with 157 reflective pixels or more, the others without errors, \
         as they have fewer than 100 reflective pixels, 0 probes",
        "(chart.svg)",
        "(chart-ms.svg)",
        "(chart-flip.svg)",
        "| 0.0000 | 0.000 | – | 0.0 | 50 | – | – | 0.0 | – | – | 7.0 | ● |",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    film.scored_px.clear();
    film.rows[0].errors = None;
    film.rows[0].frames = [0, 1]
        .map(|at| FrameRow {
            errors: None,
            ms: 0.0,
            update_ms: 0.0,
            ..frame(at)
        })
        .to_vec();
    text.clear();
    section(&mut text, &film, |ending| format!("chart{ending}.svg"));
    let unscored =
        "3 frames of 64 × 36 pixels, without errors, as they have fewer than 100 reflective pixels";
    assert!(text.contains(unscored), "{text}");
    assert!(text.contains("| 0.00 | – | – | – | – | 50 |"), "{text}");
    assert!(
        text.contains("| 7.0 |  |") && !text.contains("chart-"),
        "{text}"
    );
}
