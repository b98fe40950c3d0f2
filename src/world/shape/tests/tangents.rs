//! Normals, texture coordinates and tangents are defined for each kind of shape, at poles and tips too.

use std::collections::BTreeSet;

use reflet_scene::parse::recorded_keys;

use super::*;
use crate::{load::tangent::generate, normal_uv::NormalUv};

/// Shapes of every kind, as scene text has them.
const SHAPES: &str = include_str!("kinds.txt");

#[test]
fn every_kind_of_shape_is_checked() {
    let of_shapes = |text: &str| text.split('"').nth(1).expect("a kind").to_owned();
    let checked: BTreeSet<_> = SHAPES.lines().map(of_shapes).collect();
    let sections = recorded_keys();
    let section = sections.iter().find(|s| s.type_name == "ShapeDesc");
    let variants = &section.expect("shapes").variants;
    // The mesh of a height field is of an image, and has a test of its own.
    let known = variants.iter().map(|v| v.word.to_owned());
    let known: BTreeSet<_> = known.filter(|kind| kind != "heightfield").collect();
    assert_eq!(checked, known);
}

#[test]
fn tangents_are_unit_in_the_surface_and_along_increasing_u() {
    for text in SHAPES.lines() {
        check_tangents(text, mesh(&read(text)));
    }
    let heights = heightfield::Heights {
        width: 3,
        height: 3,
        values: vec![0.0, 0.5, 1.0, 0.2, 0.9, 0.1, 0.0, 0.0, 0.3],
    };
    let hills = heightfield::mesh(&heights, Vec3::new(1.0, 0.25, 1.0));
    check_tangents("heightfield", hills);
}

fn check_tangents(text: &str, mut mesh: Mesh) {
    generate(&mut mesh, &NormalUv::PLAIN);
    let count = mesh.positions.len();
    let streams = [mesh.normals.len(), mesh.uv0.len(), mesh.tangents.len()];
    assert_eq!(streams, [count; 3], "{text}");
    for (normal, tangent) in mesh.normals.iter().zip(&mesh.tangents) {
        let along = tangent.truncate();
        assert!((normal.length() - 1.0).abs() < 1e-4, "{text}: {normal}");
        assert!((along.length() - 1.0).abs() < 1e-4, "{text}: {tangent}");
        assert!(
            along.dot(*normal).abs() < 1e-3,
            "{text}: {tangent} {normal}"
        );
        assert!(tangent.w.abs() == 1.0, "{text}: {tangent}");
    }
    let uv_is_flat = text.contains("\"mesh\"") && !text.contains("uv");
    let has_miters = text.contains("\"linear\"");
    let least = if has_miters { 0.0 } else { 0.5 };
    let (mut flat, mut sheared) = (0, 0);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let [ua, ub, uc] = triangle.map(|i| mesh.uv0[i as usize].as_dvec2());
        let (p, q, s, t) = (b - a, c - a, ub - ua, uc - ua);
        let area = s.perp_dot(t);
        if area.abs() < 1e-12 {
            flat += 1;
            continue;
        }
        let [du, dv] = [p * t.y - q * s.y, q * s.x - p * t.x].map(|way| way / area);
        // Where a miter shears the texture, the triangles of a side disagree by up to a right angle.
        if du.normalize().dot(dv.normalize()).abs() > 0.6 {
            sheared += 1;
            continue;
        }
        for i in triangle.map(|i| i as usize) {
            let (normal, tangent) = (mesh.normals[i].as_dvec3(), mesh.tangents[i].as_dvec4());
            let along = tangent.truncate();
            let own = (du - normal * du.dot(normal)).normalize_or_zero();
            assert!(along.dot(own) > least, "{text}: {along} {own}");
            // The bitangent goes up in the texture, against v.
            let up = normal.cross(along) * tangent.w;
            assert!(up.dot(-dv) > 0.0, "{text}: {up} {dv}");
        }
    }
    assert!(
        has_miters || sheared * 4 <= mesh.triangles.len(),
        "{text}: {sheared}"
    );
    if uv_is_flat {
        assert_eq!(flat, mesh.triangles.len());
    } else {
        assert!(
            flat * 50 <= mesh.triangles.len(),
            "{text}: {flat} without area in texture"
        );
    }
}
