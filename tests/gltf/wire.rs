//! Points and lines as geometry.

use crate::kit::{Doc, warnings};
use glam::Vec3;

#[test]
fn points_and_lines_are_thin_geometry_around_them() {
    // The diagonal of the three vertices is √2 m.
    let (point, line) = (2.0_f32.sqrt() / 300.0, 2.0_f32.sqrt() / 600.0);
    for (mode, num_triangles, num_vertices, radius) in [
        (0, 3 * 8, 3 * 6, point),
        (1, 8, 8, line),
        (2, 3 * 8, 3 * 8, line),
        (3, 2 * 8, 2 * 8, line),
    ] {
        let mut doc = Doc::triangle();
        doc.primitive("mode", mode.into());
        let colors = doc.floats("VEC3", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        doc.attribute("COLOR_0", colors);
        let world = doc.world();
        assert!(world.warnings.is_empty(), "{:?}", world.warnings);
        let mesh = &world.meshes[0];
        let counts = (mesh.triangles.len(), mesh.positions.len());
        assert_eq!(counts, (num_triangles, num_vertices), "mode {mode}");
        for (i, position) in mesh.positions.iter().enumerate() {
            let center = *position - mesh.normals[i] * radius;
            let known = [Vec3::ZERO, Vec3::X, Vec3::Y];
            let at = known.iter().position(|p| p.distance(center) < 1e-6);
            let at = at.unwrap_or_else(|| panic!("mode {mode}: {position}"));
            assert_eq!(mesh.colors[i][at], 1.0, "mode {mode}: its own color");
        }
        // Triangles of the tube face outward.
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let outside: Vec3 = t.iter().map(|i| mesh.normals[*i as usize]).sum();
            assert!((b - a).cross(c - a).dot(outside) > 0.0, "mode {mode}");
        }
    }
    // A line of length 0 has no geometry.
    let mut doc = Doc::triangle();
    doc.primitive("mode", 1.into());
    let corners = doc.accessor("SCALAR", 5121, 2, &[1, 1]);
    doc.primitive("indices", corners.into());
    assert_eq!(warnings(&doc.world()), ["mesh-empty", "model-empty"]);
}
