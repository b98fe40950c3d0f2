//! Intended text that looks like a mistake.

use std::{fs, path::Path};

use super::{Found, count, folder, found, found_at};

const NONE: [Found; 0] = [];

/// Keys of a base material have an effect if a material that extends it gives them one.
#[test]
fn rooms_lanterns_candles_and_keys_that_have_an_effect_are_left_alone() {
    let lit = [include_str!("room.toml"), include_str!("candle.toml")];
    assert_eq!(lit.map(found).concat(), NONE);
    assert_eq!(found(include_str!("effect.toml")), NONE);
}

/// A cord and a word that fall between the rays which look at the view, and the same beside it.
#[test]
fn thin_things_in_the_view_are_seen() {
    let cord = "kind = \"sweep\", outline = { radius = 0.01 }, points = [[0, 0, 0], [1, 0, 0]]";
    let word = "kind = \"text\", text = \"i\", size = 0.1";
    for (shape, x, expected) in [(cord, "0", 0), (word, "0", 0), (word, "9", 1)] {
        let scene = include_str!("thin.toml")
            .replace("SHAPE", shape)
            .replace("X", x);
        assert_eq!(count("empty-view", &scene), expected, "{scene}");
    }
}

/// The surface of the light is far outside of the object that contains its middle.
#[test]
fn a_light_that_is_larger_than_what_it_stands_in_is_not_inside() {
    let aim = "direction = [0, -1, 0]";
    for (light, expected) in [
        ("kind = \"point\"\nradius_m = 0.4".to_owned(), 1),
        ("kind = \"point\"\nradius_m = 5".to_owned(), 0),
        (format!("kind = \"disk\"\n{aim}\nradius_m = 0.4"), 1),
        (format!("kind = \"disk\"\n{aim}\nradius_m = 1"), 0),
        (format!("kind = \"rect\"\n{aim}\nsize = [0.2, 3]"), 0),
    ] {
        let scene = include_str!("large_light.toml").replace("LIGHT", &light);
        assert_eq!(count("light-inside", &scene), expected, "{scene}");
    }
}

/// A mirror in the dark shows a lamp that stands where its reflection falls, and a rough metal its highlight.
#[test]
fn a_picture_that_is_lit_by_reflection_alone_is_not_black() {
    let lamp = "kind = \"rect\"\ndirection = [0, 0, -1]\nsize = [2, 2]";
    for (light, roughness, position, expected) in [
        (lamp, "0", "[0, 1, 5]", 0),
        (lamp, "0", "[0, 9, 5]", 1),
        (lamp, "0.5", "[0, 9, 5]", 0),
        ("kind = \"point\"", "0.4", "[0, 1, 5]", 0),
        ("kind = \"point\"", "0", "[0, 1, 5]", 1),
        ("kind = \"point\"", "0.4", "[0, 9, -5]", 1),
    ] {
        let scene = include_str!("lit_by_reflection.toml")
            .replace("ROUGHNESS", roughness)
            .replace("LIGHT", light)
            .replace("POSITION", position);
        assert_eq!(count("black-picture", &scene), expected, "{scene}");
    }
}

/// Black and white columns of a wall's texture, of which an even stride through its texels would meet black alone.
#[test]
fn stripes_are_half_as_bright_as_white() {
    let folder = folder("stripes");
    let column = |x: u32, _| image::Luma([if x.is_multiple_of(2) { 0_u8 } else { 255 }]);
    let stripes = image::ImageBuffer::from_fn(64, 64, column);
    stripes.save(folder.join("stripes.png")).expect("writable");
    let scene = include_str!("lit_by_reflection.toml")
        .replace(
            "metallic = 1",
            "emission = [1, 1, 1]\nemission_texture = \"stripes.png\"",
        )
        .replace("ROUGHNESS", "1")
        .replace("LIGHT", "kind = \"point\"")
        .replace("POSITION", "[0, 9, -9]");
    assert_eq!(found_at(&folder.join("scene.toml"), &scene), NONE);
}

#[test]
fn the_scenes_of_the_project_have_no_warnings() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["scenes", "scenes/examples", "scripts"] {
        let entries = fs::read_dir(root.join(folder)).expect("the folder is there");
        let paths = entries.map(|entry| entry.expect("entry").path());
        files.extend(paths.filter(|path| {
            path.extension().is_some_and(|e| e == "toml") && !path.ends_with("reflet.toml")
        }));
    }
    assert!(files.len() >= 9, "{files:?}");
    files.sort();
    for file in crate::common::sampled(files, 2) {
        let text = fs::read_to_string(&file).expect("text");
        assert_eq!(found_at(&file, &text), NONE, "{}", file.display());
    }
}
