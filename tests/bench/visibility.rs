//! Visibility that is left to `auto`: `bench` takes what `render --method rt` takes.

use super::*;

/// Mirror balls of more triangles than the picture has pixels.
const BALLS: &str = include_str!("visibility/balls.toml");

#[test]
fn rt_finds_surfaces_as_render_does() {
    found_as_render_does(&["rt"]);
}

#[test]
#[ignore = "long: measures two methods"]
fn all_methods_find_surfaces_as_render_does() {
    found_as_render_does(&["hybrid", "rt"]);
}

fn found_as_render_does(methods: &[&str]) {
    or_skip!(gpu_or_skip());
    let folder = folder(&format!("visibility-{}", methods.len()));
    let list = methods.join(",");
    for (segments, by_rays) in [("128", true), ("4", false)] {
        let text = BALLS.replace("SEGMENTS", segments);
        fs::write(folder.join("balls.toml"), text).expect("written");
        let out = format!("out-{segments}");
        let run = format!("balls.toml --methods {list} --sizes 32x18 --frames 1 --warm-up 1");
        exits(&folder, format!("{run} -o {out}"), 0);
        let samples = samples(&folder.join(&out));
        for &method in methods {
            let sample = samples.iter().find(|s| s.method == method);
            let sample = sample.expect("measured");
            assert_eq!(sample.detail("pass_primary_ms") > 0.0, by_rays, "{method}");
            let raster = sample.detail("pass_visibility_ms");
            assert_eq!(raster > 0.0, !by_rays, "{method}");
        }
    }
}
