//! Keys of a layer that replace keys below, beside which they cannot stand.

use super::layers::{BASE, Folder};

#[test]
fn a_key_above_replaces_keys_that_cannot_stand_beside_it() {
    let extruded = |outline: &str| {
        format!("[model.m]\nshape = {{ kind = \"extrude\", outline = {{ {outline} }} }}\n")
    };
    let turned = "[model.m]\nshape = { kind = \"lathe\", points = [[0.3, 0], [0.5, 0.4]] }\n";
    let moved = "[timeline]\nend = 9\n[motion.camera.main.eye]\ncurve = \"catmull_rom\"\n\
                 keys = [{ at_s = 0, value = [0, 1, 5] }, { at_s = 1, value = [0, 2, 5] }]\n";
    for (below, path, value) in [
        (
            &*extruded("path = \"M 0 0 H 1 V 1 Z\""),
            "model.m.shape.outline.radius",
            "0.3",
        ),
        (
            &extruded("rect = [2, 1], corner_radius = 0.1"),
            "model.m.shape.outline.points",
            "[[0, 0], [1, 0], [0, 1]]",
        ),
        (turned, "model.m.shape.outline", "{ radius = 0.3 }"),
        (
            moved,
            "motion.camera.main.eye.follow",
            "{ instance = \"b\" }",
        ),
    ] {
        let (below, above) = (BASE.to_owned() + below, format!("{path} = {value}\n"));
        let in_variant = format!("{below}[variant.v]\n{above}");
        let shot = format!("version = 1\nbase = \"base.toml\"\n{above}");
        let files: [(&[_], &[&str], &[&str]); 3] = [
            (&[("shot/scene.toml", in_variant.as_str())], &["v"], &[]),
            (
                &[("shot/base.toml", &below), ("shot/scene.toml", &shot)],
                &[],
                &[],
            ),
            (&[("shot/scene.toml", &below)], &[], &[&above]),
        ];
        for (files, variants, set) in files {
            let read = Folder::with(files).read(variants, set);
            read.unwrap_or_else(|errors| panic!("{above}{errors}"));
        }
    }
}
