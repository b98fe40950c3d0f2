//! Layers that remove elements which other layers change, or which are not theirs.

use crate::layers::{Folder, over_base};

#[test]
fn variants_that_remove_and_change_the_same_thing_are_named() {
    let folder = over_base(
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
    let folder = over_base("script = \"own.rhai\"\nremove = \"group.row\"\n");
    let script = "fn setup(ctx) { #{ groups: #{ row: #{ } } } }";
    std::fs::write(folder.path("shot/own.rhai"), script).expect("writable");
    folder.assert_says(
        &[],
        &[
            "nothing at \"group.row\" to remove",
            "what a script makes it can leave out by a parameter",
        ],
    );
}

const GROUP: &str = "group.cart.translation = [1, 0, 0]\n[model.ball]\nshape = { kind = \"sphere\" }\n\
    [[instance]]\nmodel = \"ball\"\nparent = \"cart\"\n[[instance]]\nmodel = \"ball\"\n\
    [[instance]]\nname = \"wheel\"\nmodel = \"ball\"\nparent = \"cart\"\n";

#[test]
fn a_group_is_removed_with_its_instances_without_a_name() {
    let shot = |removed: &str| {
        let base = format!("version = 1\n{GROUP}");
        let shot = format!("version = 1\nbase = \"base.toml\"\nremove = [{removed}]\n");
        Folder::with(&[("shot/base.toml", &base), ("shot/scene.toml", &shot)])
    };
    let scene = shot("\"group.cart\", \"instance.wheel\"").expect();
    assert_eq!((scene.groups.len(), scene.instances.len()), (0, 1));
    shot("\"group.cart\"").assert_says(&[], &["no instance or group is named \"cart\""]);
}

#[test]
fn a_panorama_and_colors_replace_each_other() {
    let base = "version = 1\n[environment]\nzenith = [1, 0, 0]\nintensity = 2\n[model.ball]\n\
        shape = { kind = \"sphere\" }\n[[instance]]\nmodel = \"ball\"\n";
    let file =
        "version = 1\nbase = \"base.toml\"\n[environment]\nfile = \"sky.hdr\"\nrotation_deg = 90\n";
    let colors = "version = 1\nbase = \"file.toml\"\n[environment]\ncolor = [0, 1, 0]\n";
    let read = |own| {
        let texts = [("base", base), ("file", file), ("scene", own)];
        let files = texts.map(|(name, text)| (format!("shot/{name}.toml"), text));
        let files = files.each_ref().map(|(name, text)| (name.as_str(), *text));
        Folder::with(&files).expect().environment.clone()
    };
    let environment = read(file);
    assert!(environment.file.is_some() && environment.intensity == 2.0);
    let environment = read(colors);
    assert!(environment.file.is_none() && environment.zenith == glam::Vec3::Y);
    let rest = (environment.rotation_deg, environment.intensity);
    assert_eq!(rest, (0.0, 2.0));
}
