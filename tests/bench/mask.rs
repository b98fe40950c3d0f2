//! The masks of `bench` and `compare --mask` are the same pixels.

use super::*;
use crate::common::program::exits;

#[test]
fn a_rendered_mask_holds_the_pixels_that_bench_scores() {
    or_skip!(gpu_or_skip());
    let folder = folder("mask");
    let run = "--sizes 128x72 --methods rt --parameter bounces --values 1";
    super::exits(&folder, format!("{run} --frames 1 --warm-up 1 -o ."), 0);
    let expected = samples(&folder)[0].mask_px;
    assert!((100..128 * 72 / 2).contains(&expected), "{expected} px");
    for picture in ["rt.png", "rt.exr"] {
        let planes = "--method rt --aov reflectance,depth";
        exits(
            &folder,
            format!("render -o {picture} --size 128x72 {planes}"),
            0,
        );
    }
    for (mask, says) in [
        ("rt.reflectance.png", "gray values"),
        ("rt.exr", "its channel reflectance.Y"),
    ] {
        let compare = format!("compare rt.png rt.png --json --mask {mask}");
        let [out, _] = exits(&folder, compare, 0);
        let found: serde_json::Value = serde_json::from_str(&out).expect("JSON");
        assert_eq!(found["mask"]["area_px"], expected, "{mask}");
        let notes = found["notes"].to_string();
        assert!(notes.contains(says), "{notes}");
    }
    let [_, error] = exits(&folder, "compare rt.png rt.png --mask rt.png", 2);
    assert!(error.contains("--aov reflectance"), "{error}");
}
