//! `bench bounds`: samples, time and error over error bounds.

use super::*;

/// A box under a soft sun: all of the error is the grain of its shadow.
const SCENE: &str = include_str!("bounds/scene.toml");

const ARGUMENTS: [&str; 6] = [
    "bounds",
    "scene.toml",
    "--size=48x32",
    "--at-most=128",
    "-o",
    "out",
];

#[test]
fn tighter_bounds_take_more_samples_and_leave_less_error() {
    or_skip!(crate::common::gpu_or_skip());
    let folder = folder("bounds");
    std::fs::write(folder.join("scene.toml"), SCENE).expect("a scene");
    let further = ["--bounds", "0.05,0.2", "--reference=512"];
    let arguments = [&ARGUMENTS[..], &further].concat();
    let [out, _] = exits(&folder, &arguments, 0);
    assert!(out.contains("measured, mean"), "{out}");
    let text = std::fs::read_to_string(folder.join("out/bounds.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let rows = report["rows"].as_array().expect("rows");
    let of = |row: usize, key: &str| rows[row][key].as_f64().expect("a number");
    assert_eq!(
        (of(0, "bound"), of(1, "bound")),
        (0.2, 0.05),
        "from the widest on"
    );
    assert!(of(1, "samples") >= of(0, "samples"));
    for row in 0..2 {
        let (estimated, measured) = (of(row, "estimated"), of(row, "measured"));
        assert!(measured < 3.0 * estimated, "{measured} of {estimated}");
        assert!(measured > 0.2 * estimated, "{measured} of {estimated}");
        assert!(of(row, "measured_mean") < measured && of(row, "wall_s") > 0.0);
    }
    assert!(of(1, "measured") <= of(0, "measured"));
    for chart in ["time", "error"] {
        let svg = std::fs::read_to_string(folder.join(format!("out/bounds-{chart}.svg")));
        assert!(svg.expect("a chart").contains("error bound"));
    }
    let few = [&ARGUMENTS[..], &["--reference=128"]].concat();
    let [_, error] = exits(&folder, &few, 2);
    assert!(error.contains("--reference 128") && error.contains("--at-most 128"));
}
