//! The masks of `bench` and `compare --mask` are the same pixels.

use std::process::Command;

use super::{exits, folder, samples};
use crate::common::gpu_or_skip;

#[test]
fn a_rendered_mask_holds_the_pixels_that_bench_scores() {
    or_skip!(gpu_or_skip());
    let folder = folder("mask");
    let reflet = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_reflet"));
        let command = command.current_dir(&folder).args(arguments);
        let output = command.env("NODEVICE_SELECT", "1").output();
        let output = output.expect("the program starts");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), output.stdout, error)
    };
    let size = "128x72";
    let run = ["--sizes", size, "--methods", "rt", "--parameter", "bounces"];
    let short = ["--values", "1", "--frames", "1", "--warm-up", "1"];
    exits(&folder, &[&run[..], &short, &["-o", "."]].concat(), 0);
    let expected = samples(&folder)[0].mask_px;
    assert!((100..128 * 72 / 2).contains(&expected), "{expected} px");
    for picture in ["rt.png", "rt.exr"] {
        let planes = ["--method", "rt", "--aov", "reflectance,depth"];
        let (code, _, error) =
            reflet(&[&["render", "-o", picture, "--size", size], &planes[..]].concat());
        assert_eq!(code, Some(0), "{error}");
    }
    for (mask, says) in [
        ("rt.reflectance.png", "gray values"),
        ("rt.exr", "its channel reflectance.Y"),
    ] {
        let (code, out, error) = reflet(&["compare", "rt.png", "rt.png", "--json", "--mask", mask]);
        assert_eq!(code, Some(0), "{error}");
        let found: serde_json::Value = serde_json::from_slice(&out).expect("JSON");
        assert_eq!(found["mask"]["area_px"], expected, "{mask}");
        let notes = found["notes"].to_string();
        assert!(notes.contains(says), "{notes}");
    }
    let (code, _, error) = reflet(&["compare", "rt.png", "rt.png", "--mask", "rt.png"]);
    assert_eq!(code, Some(2));
    assert!(error.contains("--aov reflectance"), "{error}");
}
