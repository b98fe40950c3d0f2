//! Shapes made of outlines: bevels, profiles and normals.

use super::*;

/// Corners of a smaller radius than the bevel shrink to nothing on the way.
#[test]
fn bevels_go_on_where_sides_shrink_to_nothing() {
    let outline = "outline = { rect = [2, 1], corner_radius = 0.05 }";
    let inner = 1.6 * 0.6;
    // Steps that end before, at and after the distance at which the corners are gone.
    for steps in [1, 2, 3, 8] {
        let bevel = format!("bevel = 0.2, bevel_segments = {steps}");
        let mesh = mesh(&read(&format!(
            r#"{{ kind = "extrude", depth = 1, {bevel}, {outline} }}"#
        )));
        assert_eq!(open_edges(&mesh), 0, "{steps}");
        let face: f64 = (corners(&mesh))
            .filter(|corners| corners.iter().all(|p| p.z == 1.0))
            .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
            .sum();
        assert!((face / inner - 1.0).abs() < 1e-3, "{steps}: {face}");
    }
}

#[test]
fn the_profile_of_a_sweep_stands_upright_and_turns_with_the_clock() {
    // Along -Z the profile's x is +X and its y is +Y.
    let flag = r#"kind = "sweep", curve = "linear", points = [[0, 0, 0], [0, 0, -1]],
                  outline = { path = "M 0 0 H 2 V 1 H 0 Z" }"#;
    let bounds = mesh(&read(&format!("{{ {flag} }}"))).bounds;
    assert_eq!(bounds.min, Vec3::new(0.0, 0.0, -1.0));
    assert_eq!(bounds.max, Vec3::new(2.0, 1.0, 0.0));
    // At the end x is down and y is right.
    let mesh = mesh(&read(&format!("{{ {flag}, twist_deg = 90 }}")));
    let end = mesh.positions.iter().filter(|p| p.z == -1.0);
    let most = end.fold(Vec3::NEG_INFINITY, |most, p| most.max(*p));
    assert!(most.distance(Vec3::new(1.0, 0.0, -1.0)) < 1e-6, "{most}");
}

#[test]
fn normals_of_curves_are_their_own_and_not_of_their_chords() {
    // Beside the round corners the long sides stay flat.
    let outline = "outline = { rect = [4, 2], corner_radius = 0.5 }";
    let mesh = mesh(&read(&format!(
        r#"{{ kind = "extrude", depth = 1, {outline} }}"#
    )));
    let mut seen = 0;
    for (at, normal) in mesh.positions.iter().zip(&mesh.normals) {
        let (x, y) = (at.x.abs(), at.y.abs());
        if normal.z == 0.0 && (x, y) == (1.5, 1.0) {
            seen += 1;
            assert!(normal.y.abs() > 1.0 - 1e-6, "{at}: {normal}");
        }
    }
    assert!(seen >= 8, "{seen}");
}
