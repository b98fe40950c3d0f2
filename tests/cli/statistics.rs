//! Times in the output of `--stats`.

use super::*;

/// Software drivers compile pipelines in a sub-frame that is not timed; of shadow maps that draws no more than their pipelines need.
#[test]
fn passes_are_timed_after_a_warm_up_that_changes_no_picture() {
    or_skip!(gpu_or_skip());
    let folder = folder("statistics");
    let render = |output: &str, stats: &[&str]| {
        let scene = ["render", "scene.toml", "--size", "33x17", "--samples", "2"];
        let visibility = ["--set", "image.visibility=raster", "-o", output];
        exits(&folder, [&scene[..], &visibility, stats].concat(), 0)
    };
    let [out, _] = render("a.png", &["--stats", "json"]);
    let stats: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    let is_software = stats["software"] == true;
    assert_eq!(
        stats["warm_up_ms"].as_f64() > Some(0.0),
        is_software,
        "{out}"
    );
    let shadow = stats["passes_ms"]["shadow"].as_f64();
    assert!(shadow > Some(0.0), "{out}");
    render("b.png", &[]);
    let [timed, untimed] = ["a.png", "b.png"].map(|name| fs::read(folder.join(name)));
    assert!(timed.expect("a picture") == untimed.expect("a picture"));
}
