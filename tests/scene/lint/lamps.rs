//! Warnings about lamps of the light tree.

use super::{found, only};

/// Where lights are too many for maps, their lamps are named once, and where maps take much memory; rays and maps that
/// nobody asked for are nothing to warn of.
#[test]
fn lamps_without_the_map_that_is_asked_for_are_counted() {
    let lit = |count: u32, shadow: &str| {
        let lamp = |n: u32| {
            let shadow = if n < 2 { "shadow = \"ray\"" } else { shadow };
            format!(
                "[light.l{n}]\nkind = \"point\"\nposition = [{}, 3, 0]\nintensity_cd = 1\n{shadow}\n",
                n as f32 / 16.0
            )
        };
        let lamps: String = (0..count).map(lamp).collect();
        format!("{}{lamps}", include_str!("floor.toml"))
    };
    let map = "shadow = \"map\"";
    for (count, shadow) in [(12, map), (64, ""), (66, "")] {
        assert!(found(&lit(count, shadow)).is_empty(), "{count} {shadow}");
    }
    for (count, expected) in [
        (
            64,
            [
                "of 62 lights",
                "\"l2\" the first",
                "1488 MiB",
                "at most 256 MiB",
            ],
        ),
        (
            66,
            [
                "66 lights, and shadow maps are for at most 64",
                "of 64 with",
                "\"l2\" the first",
                "write `shadow = \"ray\"`",
            ],
        ),
    ] {
        let [_, at, says] = only(&lit(count, map));
        assert_eq!(at, "17:8");
        assert!(expected.iter().all(|part| says.contains(part)), "{says}");
    }
}
