//! Warnings about lamps of the light tree.

use super::{count, found, only};

/// Where lights are too many for maps, their lamps are named once, and where maps take much memory; rays and maps that
/// nobody asked for or that rays stand in for are nothing to warn of, but for the size of such a map. Each lamp that paths
/// do not find is named.
#[test]
fn lamps_without_the_map_that_is_asked_for_are_counted() {
    let lit = |more: &str, count: u32, shadow: &str| {
        let lamp = |n: u32| {
            let shadow = if n < 2 { "shadow = \"ray\"" } else { shadow };
            format!(
                "[light.l{n}]\nkind = \"point\"\nposition = [{}, 3, 0]\nintensity_cd = 1\n{shadow}\n",
                n as f32 / 16.0
            )
        };
        let lamps: String = (0..count).map(lamp).collect();
        format!("{}{more}{lamps}", include_str!("floor.toml"))
    };
    let map = "shadow = \"map\"";
    let path = "[reflection]\nmethod = \"path\"\n";
    let pane = "material = \"pane\"\n[material.pane]\nalpha = 0.5\n";
    let metal = "material = \"metal\"\n[material.metal]\nmetallic = 1\nroughness = 0.5\n";
    let glass = "material = \"glass\"\n[material.glass]\ntransmission = 1\nroughness = 0.2\n";
    assert_eq!(count("lost-light", &lit(&[glass, path].concat(), 3, "")), 3);
    for (more, count, shadow) in [("", 12, map), ("", 64, ""), ("", 66, ""), (metal, 66, "")] {
        let all = found(&lit(more, count, shadow));
        assert!(all.is_empty(), "{count} {shadow} {all:?}");
    }
    for more in [path, pane] {
        assert!(found(&lit(more, 64, map)).is_empty(), "{more}");
    }
    for (count, shadow, expected) in [
        (64, map, "of 62 lights|1488 MiB|at most 256 MiB"),
        (66, map, "66 lights|at most 64|of 64 with|write `shadow"),
        (3, "shadow_px = 4096", "changes nothing|write `shadow"),
    ] {
        let [_, at, says] = only(&lit("", count, shadow));
        assert_eq!(at, "17:8");
        let mut expected = expected.split('|').chain(["\"l2\""]);
        assert!(expected.all(|part| says.contains(part)), "{says}");
    }
}
