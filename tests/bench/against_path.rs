//! `--against-path`: the model's error beside the method's.

use super::*;

/// A mirror below a white wall that only other walls light: `rt` leaves it dark, all paths do not.
const SCENE: &str = include_str!("against_path/scene.toml");

#[test]
fn a_second_reference_judges_the_model() {
    or_skip!(gpu_or_skip());
    let folder = folder("against-path");
    fs::write(folder.join("room.toml"), SCENE).expect("a scene");
    let run: Vec<&str> =
        "room.toml --methods rt --sizes 32x18 --frames 1 --warm-up 1 --against-path 32 -o out"
            .split(' ')
            .collect();
    exits(&folder, &run, 0);
    let found = samples(&folder.join("out"));
    let flip = |by_path: bool| {
        let of = found
            .iter()
            .find(|s| s.scene.ends_with("against path") == by_path);
        of.expect("measured").flip.expect("judged")
    };
    assert!(
        flip(false) < 0.01 && flip(true) > 0.1,
        "{} {}",
        flip(false),
        flip(true)
    );
    let moving = SCENE.replace(
        "version = 1",
        "version = 1\ntimeline = { fps = 1, end = 3 }",
    ) + "name = \"lamp\"\n[motion.instance.lamp]\ntranslation = { rate = [0, 1, 0] }\n";
    fs::write(folder.join("moving.toml"), moving).expect("a scene");
    let run: Vec<&str> = "moving.toml --against-path 4 -o moved".split(' ').collect();
    let [_, error] = exits(&folder, &run, 2);
    assert!(
        error.contains("moves") && !folder.join("moved").exists(),
        "{error}"
    );
}
