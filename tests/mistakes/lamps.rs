//! Warnings about lamps of the light tree.

use std::fs;

use super::{folder, place, results};

/// A scene with a floor and no light.
const FLOOR: &str = "version = 1\n[camera.main]\neye = [0, 2, 6]\ntarget = [0, 0.5, 0]\n\
    [model.floor]\nshape = { kind = \"plane\", size = [8, 8] }\n";

/// Where lights are too many for maps, their lamps are named once; rays that were asked for are nothing to warn of.
#[test]
fn lamps_without_the_map_that_is_asked_for_are_counted() {
    let folder = folder("lamps");
    let lamp = |n: u32, shadow: &str| {
        format!(
            "[light.l{n}]\nkind = \"point\"\nposition = [{}, 3, 0]\nintensity_cd = 1\n{shadow}",
            n as f32 / 16.0
        )
    };
    let rays = "shadow = \"ray\"\n";
    let checked = |count: u32| {
        let lamps: String = (0..count)
            .map(|n| lamp(n, if n < 2 { rays } else { "" }))
            .collect();
        let text = format!("{FLOOR}{lamps}");
        fs::write(folder.join("scene.toml"), text).expect("writable");
        results(&folder, &["scene.toml".to_owned()], 0)
    };
    assert!(checked(64).is_empty());
    let found = checked(66);
    let [one] = &found[..] else {
        panic!("{found:#?}")
    };
    assert_eq!(place(one).0, "17:8");
    let says = one["message"]["text"].as_str().expect("a text");
    let expected = [
        "66 lights",
        "at most 64",
        "of 64 with",
        "\"l2\" the first",
        "write `shadow = \"ray\"`",
    ];
    assert!(expected.iter().all(|part| says.contains(part)), "{says}");
}
