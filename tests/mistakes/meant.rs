//! Intended text that looks like the mistakes of `lint`.

use std::{fs, path::Path};

use super::{folder, results};

#[test]
fn rooms_and_lanterns_are_left_alone() {
    let folder = folder("meant");
    let room = "version = 1\n[camera.main]\neye = [0, 0, 3]\ntarget = [0, 0, 0]\n[light.lamp]\n\
                kind = \"point\"\nposition = [0, 1, 0]\nintensity_cd = 20\n[model.room]\n\
                shape = { kind = \"box\", size = [8, 8, 8] }\n[model.ball]\n\
                shape = { kind = \"sphere\" }\n[model.glass]\nshape = { kind = \"sphere\", radius = 0.1 }\n\
                [[instance]]\nmodel = \"room\"\n[[instance]]\nmodel = \"ball\"\n[[instance]]\n\
                model = \"glass\"\ntranslation = [0, 1, 0]\nmaterial = { alpha_cutoff = 0.5 }\n";
    fs::write(folder.join("room.toml"), room).expect("writable");
    let found = results(&folder, &["room.toml".to_owned()], 0);
    assert_eq!(found, [0; 0].map(serde_json::Value::from));
}

/// A cord and a word that fall between the rays which look at the view, and the same beside it.
#[test]
fn thin_things_in_the_view_are_seen() {
    let folder = folder("thin");
    for (shape, x, expected) in [
        (
            "kind = \"sweep\", outline = { radius = 0.01 }, points = [[0, 0, 0], [1, 0, 0]]",
            0,
            0,
        ),
        ("kind = \"text\", text = \"i\", size = 0.1", 0, 0),
        ("kind = \"text\", text = \"i\", size = 0.1", 9, 1),
    ] {
        let scene = format!(
            "version = 1\n[camera.main]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n[environment]\ncolor = [1, 1, 1]\n\
             [model.thin]\nshape = {{ {shape} }}\n[[instance]]\nmodel = \"thin\"\ntranslation = [{x}, 0, 0]\n"
        );
        fs::write(folder.join("scene.toml"), scene).expect("writable");
        let found = results(&folder, &["scene.toml".to_owned()], 0);
        let empty = found.iter().filter(|f| f["ruleId"] == "empty-view");
        assert_eq!(empty.count(), expected, "{shape}: {found:#?}");
    }
}

/// The surface of the light is far outside of the object that contains its middle.
#[test]
fn a_light_that_is_larger_than_what_it_stands_in_is_not_inside() {
    let folder = folder("large-light");
    let aim = "direction = [0, -1, 0]";
    let lights = [
        ("kind = \"point\"\nradius_m = 0.4".to_owned(), 1),
        ("kind = \"point\"\nradius_m = 5".to_owned(), 0),
        (format!("kind = \"disk\"\n{aim}\nradius_m = 0.4"), 1),
        (format!("kind = \"disk\"\n{aim}\nradius_m = 1"), 0),
        (format!("kind = \"rect\"\n{aim}\nsize = [0.2, 3]"), 0),
    ];
    for (light, expected) in lights {
        let scene = format!(
            "version = 1\n[camera.main]\neye = [0, 9, 9]\ntarget = [0, 0, 0]\n[light.lamp]\n\
             position = [0, 0, 0]\nintensity_cd = 2000\n{light}\n[model.ball]\n\
             shape = {{ kind = \"sphere\", radius = 0.45 }}\n[model.floor]\n\
             shape = {{ kind = \"plane\", size = [8, 8] }}\n[[instance]]\nmodel = \"ball\"\n\
             [[instance]]\nmodel = \"floor\"\ntranslation = [0, -6, 0]\n"
        );
        fs::write(folder.join("scene.toml"), scene).expect("writable");
        let found = results(&folder, &["scene.toml".to_owned()], 0);
        let inside = found.iter().filter(|f| f["ruleId"] == "light-inside");
        assert_eq!(inside.count(), expected, "{light}: {found:#?}");
    }
}

/// A mirror in the dark shows a lamp that stands where its reflection falls, and a rough metal its highlight.
#[test]
fn a_picture_that_is_lit_by_reflection_alone_is_not_black() {
    let folder = folder("lit-by-reflection");
    let lamp = "kind = \"rect\"\ndirection = [0, 0, -1]\nsize = [2, 2]";
    let cases = [
        (lamp, 0.0, "[0, 1, 5]", 0),
        (lamp, 0.0, "[0, 9, 5]", 1),
        (lamp, 0.5, "[0, 9, 5]", 0),
        ("kind = \"point\"", 0.4, "[0, 1, 5]", 0),
        ("kind = \"point\"", 0.0, "[0, 1, 5]", 0),
        ("kind = \"point\"", 0.0, "[0, 9, 5]", 1),
    ];
    for (light, roughness, position, expected) in cases {
        let scene = format!(
            "version = 1\n[camera.main]\neye = [0, 1, 3]\ntarget = [0, 0.5, 0]\n[material.metal]\n\
             metallic = 1\nroughness = {roughness}\n[model.wall]\nmaterial = \"metal\"\n\
             shape = {{ kind = \"box\", size = [3, 3, 0.1] }}\n[[instance]]\nmodel = \"wall\"\n\
             [light.lamp]\n{light}\nposition = {position}\nintensity_cd = 100\n"
        );
        fs::write(folder.join("scene.toml"), scene).expect("writable");
        let found = results(&folder, &["scene.toml".to_owned()], 0);
        let black = found.iter().filter(|f| f["ruleId"] == "black-picture");
        let case = format!("{light}, roughness {roughness}, at {position}");
        assert_eq!(black.count(), expected, "{case}: {found:#?}");
    }
}

/// Keys of a base material have an effect if a material that extends it gives them one.
#[test]
fn keys_that_have_an_effect_are_left_alone() {
    let folder = folder("effect");
    let scene = "version = 1\n[environment]\ncolor = [1, 1, 1]\n[camera.main]\neye = [0, 1, 6]\n\
                 target = [0, 0, 0]\n[image]\nshutter = 0.5\n[timeline]\nend = 3\n\
                 [material.base]\nthickness_m = 0.1\nattenuation_color = [1, 0.5, 0.5]\n\
                 [material.glass]\nextends = \"base\"\ntransmission = 0\nattenuation_distance_m = 1\n\
                 [model.ball]\nshape = { kind = \"sphere\" }\nmaterial = \"glass\"\n\
                 [motion.material.glass]\ntransmission = { keys = [{ at_s = 0, value = 0 }, { at_s = 0.1, value = 1 }] }\n";
    fs::write(folder.join("scene.toml"), scene).expect("writable");
    let found = results(&folder, &["scene.toml".to_owned()], 0);
    assert_eq!(found, [0; 0].map(serde_json::Value::from));
}

#[test]
fn the_scenes_of_the_project_have_no_warnings() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["scenes", "scenes/examples", "scripts"] {
        let entries = fs::read_dir(root.join(folder)).expect("the folder is there");
        let paths = entries.map(|entry| entry.expect("entry").path());
        let is_scene = |path: &Path| {
            path.extension().is_some_and(|e| e == "toml") && !path.ends_with("reflet.toml")
        };
        let scenes = paths.filter(|path| is_scene(path));
        files.extend(scenes.map(|path| path.display().to_string()));
    }
    assert!(files.len() >= 9, "{files:?}");
    files.sort();
    let found = results(root, &files, 0);
    assert!(found.is_empty(), "{found:#?}");
}
