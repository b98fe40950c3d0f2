//! `bench regret`: the choice of `auto` beside the fastest alternative.

use super::*;
use crate::common::words;

const ROOM: &str = include_str!("../../scenes/cornell.toml");

/// Folder with a scene for which `auto` chooses shadows too; none without an adapter.
fn room(name: &str) -> Option<PathBuf> {
    gpu_or_skip()?;
    let folder = folder(name);
    let lit = ROOM.replace("kind = \"point\"", "kind = \"point\"\nshadow = \"auto\"");
    assert_ne!(lit, ROOM);
    fs::write(folder.join("room.toml"), lit).expect("written");
    Some(folder)
}

#[test]
fn it_lists_choice_and_best() {
    let Some(folder) = room("regret") else { return };
    let arguments = ["regret", "room.toml", "--sizes", "32x18", "--frames", "1"];
    let [table, _] = exits(&folder, arguments, 0);
    assert!(
        table.starts_with("| scene |") && table.lines().count() == 3,
        "{table}"
    );
    let [_, error] = exits(&folder, "regret none.toml", 3);
    assert!(error.contains("none.toml"), "{error}");
}

#[test]
#[ignore = "long: measures all methods in two sizes"]
fn it_lists_each_scene_and_size_with_its_regret() {
    let folder = or_skip!(room("regret-sizes"));
    let arguments = words("regret room.toml --sizes 32x18,64x36 --frames 2");
    let [json, _] = exits(&folder, [&arguments[..], &["--json"]].concat(), 0);
    let rows: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let rows = rows.as_array().expect("a list");
    assert_eq!(rows.len(), 2);
    for (row, size) in rows.iter().zip([[32, 18], [64, 36]]) {
        assert_eq!(row["size"], serde_json::json!(size));
        let number = |name: &str| row[name].as_f64().expect(name);
        assert!(number("regret") >= 1.0 && number("best_ms") > 0.0, "{row}");
        let ratio = number("chosen_ms") / number("best_ms");
        assert!((number("regret") - ratio).abs() < 1e-9, "{row}");
    }
}
