//! Probes that see nothing of the scene, or that are too many.

use std::fs;

use super::{folder, place, results};

/// A lit floor with a wall, which is a closed box.
const WALL: &str = "version = 1\n[environment]\ncolor = [1, 1, 1]\n[camera.main]\neye = [0, 2, 6]\ntarget = [0, 0.5, 0]\n\
    [model.floor]\nshape = { kind = \"plane\", size = [8, 8] }\n\
    [model.wall]\nshape = { kind = \"box\", size = [0.2, 4, 4] }\n\
    [[instance]]\nmodel = \"floor\"\n[[instance]]\nmodel = \"wall\"\ntranslation = [3, 1, 0]\n";

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
    let grid = "[reflection]\nmethod = \"probe\"\n[probes]\nspacing_m = 0.01\n";
    let refused = found("grid", grid, 3);
    let [[name, place, says]] = &refused[..] else {
        panic!("{refused:#?}")
    };
    assert_eq!((name.as_str(), place.as_str()), ("too-many-probes", "19:1"));
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
