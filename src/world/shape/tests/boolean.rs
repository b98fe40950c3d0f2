//! Volumes of combined shapes add up.

use super::*;

fn volume(shape: &str) -> f64 {
    let mesh = mesh(&read(shape));
    check_joined(&mesh, shape);
    area_and_volume(&mesh).1
}

/// Inclusion and exclusion: |A ∪ B| + |A ∩ B| = |A| + |B|, and |A ∖ B| = |A| − |A ∩ B|.
#[test]
fn volumes_of_combined_shapes_add_up() {
    let shapes = [
        r#"{ kind = "box", size = [1, 0.7, 0.9] }"#,
        r#"{ kind = "sphere", radius = 0.6, segments = 24 }"#,
        r#"{ kind = "cylinder", radius = 0.4, height = 1.2, segments = 24 }"#,
        r#"{ kind = "torus", radius = 0.5, tube_radius = 0.2, segments = 24 }"#,
        r#"{ kind = "cone", radius = 0.5, height = 1, segments = 24 }"#,
    ];
    let mut turn = 0.3_f32;
    for a in shapes {
        for b in shapes {
            turn += 1.7;
            let rotation = [turn, 2.0 * turn, 0.5 * turn].map(f32::to_degrees);
            let offset = [0.1 * turn.sin(), 0.2, 0.1 * turn.cos()];
            let second = format!(
                "shape = {b}, translation = {offset:?}, rotation_deg = {rotation:?}, scale = [1, 1.2, 0.9]"
            );
            let [union, both, left] = ["union", "intersection", "difference"].map(|kind| {
                let parts = format!("[{{ shape = {a} }}, {{ {second} }}]");
                volume(&format!("{{ kind = \"{kind}\", parts = {parts} }}"))
            });
            let own = [volume(a), 1.08 * volume(b)];
            assert!((union + both - own[0] - own[1]).abs() < 1e-4, "{a} {b}");
            assert!((left + both - own[0]).abs() < 1e-4, "{a} {b}");
        }
    }
}
