//! Warnings about lamps of the light tree.

use super::{found, only};

/// Where lights are too many for maps, their lamps are named once; rays that were asked for are nothing to warn of.
#[test]
fn lamps_without_the_map_that_is_asked_for_are_counted() {
    let lamp = |n: u32| {
        let x = n as f32 / 16.0;
        let rays = if n < 2 { "shadow = \"ray\"\n" } else { "" };
        format!("[light.l{n}]\nkind = \"point\"\nposition = [{x}, 3, 0]\nintensity_cd = 1\n{rays}")
    };
    let lit = |count: u32| {
        let lamps: String = (0..count).map(lamp).collect();
        format!("{}{lamps}", include_str!("floor.toml"))
    };
    assert!(found(&lit(64)).is_empty());
    let [_, at, says] = only(&lit(66));
    assert_eq!(at, "17:8");
    let expected = [
        "66 lights",
        "at most 64",
        "of 64 with",
        "\"l2\" the first",
        "write `shadow = \"ray\"`",
    ];
    assert!(expected.iter().all(|part| says.contains(part)), "{says}");
}
