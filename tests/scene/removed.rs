//! Layers that remove elements which other layers change, or which are not theirs.

use crate::layers::over_base;

#[test]
fn variants_that_remove_and_change_the_same_thing_are_named() {
    let folder = over_base(
        "disputed",
        "[variant.dim.light.lamp]\nintensity_cd = 1\n[variant.whole]\nlight.lamp = { kind = \"point\", \
         position = [0, 1, 0], intensity_cd = 2 }\n[variant.alone]\nremove = \"light.lamp\"\n\
         light.lamp.intensity_cd = 1\n",
    );
    folder.assert_says(
        &["dusk", "dim"],
        &[
            "variant \"dusk\" removes `light.lamp`, of which variant \"dim\" changes keys",
            "scene.toml:3:1",
            "choose \"dim\" before \"dusk\"",
            "base.toml:29:11",
        ],
    );
    folder.assert_says(
        &["alone"],
        &["`kind` is missing in `[light.lamp]`", "is removed here"],
    );
    for chosen in [["dim", "dusk"], ["dusk", "whole"]] {
        let read = folder.read(&chosen, &[]);
        assert!(read.is_ok(), "{chosen:?}: {read:?}");
    }
}

#[test]
fn what_a_script_makes_is_not_removed() {
    let folder = over_base("made", "script = \"own.rhai\"\nremove = \"group.row\"\n");
    let script = "fn setup(ctx) { #{ groups: #{ row: #{ } } } }";
    std::fs::write(folder.path().join("shot/own.rhai"), script).expect("writable");
    folder.assert_says(
        &[],
        &[
            "nothing at \"group.row\" to remove",
            "what a script makes it can leave out by a parameter",
        ],
    );
}
