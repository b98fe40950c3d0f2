//! Shapes are closed, right way round, and near their closed forms.

use std::{collections::HashMap, f64::consts::PI, path::Path};

use glam::DVec3;

use super::*;
use reflet_scene::{
    desc::{BevelDesc, ModelSource},
    stages::Scene,
};

/// A shape as scene text has it.
fn read(shape: &str) -> ShapeDesc {
    let text = format!("version = 1\n[camera.a]\n[model.a]\nshape = {shape}\n");
    let (scene, _) = Scene::from_text(&text, Path::new("a.toml"), &[])
        .unwrap_or_else(|mistakes| panic!("{shape}: {mistakes:?}"));
    match &scene.desc.models[0].value.source {
        ModelSource::Shape(shape) => shape.clone(),
        ModelSource::File(_) => panic!("{shape}: no shape"),
    }
}

fn mesh(shape: &ShapeDesc) -> Mesh {
    make(shape, &Supplies::default()).expect("a shape").mesh
}

fn cuboid(size: Vec3) -> ShapeDesc {
    let bevel = BevelDesc::default();
    ShapeDesc::Box { size, bevel }
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> {
    let at = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles.iter().map(move |t| t.map(at))
}

fn area_and_volume(mesh: &Mesh) -> (f64, f64) {
    corners(mesh).fold((0.0, 0.0), |(area, volume), [a, b, c]| {
        let twice = (b - a).cross(c - a);
        (area + twice.length() / 2.0, volume + a.dot(twice) / 6.0)
    })
}

/// Number of directed edges without a partner in the other direction.
fn open_edges(mesh: &Mesh) -> usize {
    let mut edges: HashMap<_, i32> = HashMap::new();
    for [a, b, c] in corners(mesh) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            // +0.0 and -0.0 are the same place.
            let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
            *edges.entry((key(from), key(to))).or_default() += 1;
            *edges.entry((key(to), key(from))).or_default() -= 1;
        }
    }
    edges.values().filter(|n| **n != 0).count() / 2
}

fn check(shape: ShapeDesc, area: f64, volume: f64, tolerance: f64) {
    let mesh = mesh(&shape);
    assert_eq!(mesh.normals.len(), mesh.positions.len());
    assert_eq!(mesh.uv0.len(), mesh.positions.len());
    for (t, [a, b, c]) in mesh.triangles.iter().zip(corners(&mesh)) {
        let face = (b - a).cross(c - a);
        assert!(face.length() > 0.0, "{shape:?}: degenerate {t:?}");
        for i in t {
            let normal = mesh.normals[*i as usize];
            assert!((normal.length() - 1.0).abs() < 1e-5, "{shape:?}: {normal}");
            let agrees = normal.as_dvec3().dot(face.normalize());
            assert!(agrees > 0.3, "{shape:?}: normal and winding: {agrees}");
            let uv = mesh.uv0[*i as usize];
            assert!(uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all());
        }
    }
    let (got_area, got_volume) = area_and_volume(&mesh);
    assert!((got_area / area - 1.0).abs() < tolerance, "{got_area}");
    if volume > 0.0 {
        assert_eq!(open_edges(&mesh), 0, "{shape:?}");
        assert!(
            (got_volume / volume - 1.0).abs() < tolerance,
            "{got_volume}"
        );
    } else {
        let rim = match shape {
            ShapeDesc::Disk { segments, .. } => segments as usize,
            _ => 4,
        };
        assert_eq!(open_edges(&mesh), rim);
    }
}

#[test]
fn flat_shapes_are_exact() {
    check(ShapeDesc::Plane { size: [2.0, 3.0] }, 6.0, 0.0, 1e-6);
    let size = Vec3::new(1.0, 2.0, 3.0);
    check(cuboid(size), 22.0, 6.0, 1e-6);
    let plane = mesh(&ShapeDesc::Plane { size: [1.0, 1.0] });
    assert!(plane.normals.iter().all(|n| *n == Vec3::Y));
}

/// A bottle: a floor, a bulge, a neck and a lid; and a cone upside down.
#[test]
fn outlines_turned_are_closed_and_near_their_closed_form() {
    let segments = 256;
    let lathe = |points: &[[f32; 2]]| ShapeDesc::Lathe {
        source: LatheSource::Points(points.to_vec()),
        segments,
        angle_deg: 360.0,
    };
    let cylinder = lathe(&[[0.0, 0.0], [0.5, 0.0], [0.5, 2.0], [0.0, 2.0]]);
    check(
        cylinder,
        PI * 0.5 * (2.0 * 2.0 + 2.0 * 0.5),
        PI * 0.25 * 2.0,
        1e-3,
    );
    let cone = lathe(&[[0.0, 0.0], [0.5, 1.0], [0.0, 1.0]]);
    let slant = 1.25_f64.sqrt();
    check(cone, PI * 0.5 * (slant + 0.5), PI * 0.25 / 3.0, 1e-3);
    // Smooth where it bends little, an edge where it bends much.
    let mesh = mesh(&lathe(&[[0.5, 0.0], [0.5, 1.0], [0.45, 2.0], [0.2, 2.0]]));
    let at = |y: f32, x: f32| {
        let near = |p: &Vec3| (p.y - y).abs() < 1e-6 && (p.z - x).abs() < 1e-6;
        let all = mesh.positions.iter().zip(&mesh.normals);
        let mut found: Vec<_> = all.filter(|(p, _)| near(p)).map(|(_, n)| *n).collect();
        found.dedup_by(|a, b| a.distance(*b) < 1e-6);
        found.len()
    };
    assert_eq!((at(1.0, 0.5), at(2.0, 0.45)), (1, 2));
}

#[test]
fn curved_shapes_are_closed_and_near_their_closed_form() {
    let (r, h) = (0.5_f64, 2.0_f64);
    let ball = 4.0 / 3.0 * PI * r.powi(3);
    for (shape, area, volume) in [
        (r#"kind = "sphere""#, 4.0 * PI * r * r, ball),
        (
            r#"kind = "cylinder", height = 2"#,
            2.0 * PI * r * (r + h),
            PI * r * r * h,
        ),
        (
            r#"kind = "cone", height = 2"#,
            PI * r * (r + r.hypot(h)),
            PI * r * r * h / 3.0,
        ),
        (r#"kind = "disk""#, PI * r * r, 0.0),
        (
            r#"kind = "torus", tube_radius = 0.2"#,
            4.0 * PI * PI * r * 0.2,
            2.0 * PI * PI * r * 0.04,
        ),
        (
            r#"kind = "capsule", height = 2"#,
            2.0 * PI * r * h,
            PI * r * r + ball,
        ),
        (r#"kind = "capsule", height = 1"#, 2.0 * PI * r, ball),
    ] {
        let shape = read(&format!("{{ {shape}, radius = 0.5, segments = 256 }}"));
        check(shape.clone(), area, volume, 1e-3);
        if let ShapeDesc::Capsule { height, .. } = shape {
            let bounds = mesh(&shape).bounds;
            assert_eq!((bounds.min.y, bounds.max.y), (0.0, height));
        }
    }
}

/// Shapes of `segments` sides.
fn round_shapes(segments: u32) -> impl Iterator<Item = ShapeDesc> {
    let kinds = [
        r#"kind = "sphere""#,
        r#"kind = "cylinder", height = 1"#,
        r#"kind = "cone", height = 1"#,
        r#"kind = "torus", tube_radius = 0.5"#,
        r#"kind = "capsule", height = 3"#,
    ];
    let text = move |kind| format!("{{ {kind}, radius = 1, segments = {segments} }}");
    kinds.into_iter().map(move |kind| read(&text(kind)))
}

#[test]
fn coarsest_curved_shapes_are_closed() {
    for shape in round_shapes(3) {
        let mesh = mesh(&shape);
        assert_eq!(open_edges(&mesh), 0, "{shape:?}");
        assert!(area_and_volume(&mesh).1 > 0.1, "{shape:?}");
    }
}

#[test]
fn texture_runs_left_to_right_seen_from_outside() {
    let flat = [cuboid(Vec3::ONE), ShapeDesc::Plane { size: [1.0, 1.0] }];
    for shape in round_shapes(16).chain(flat) {
        let mesh = mesh(&shape);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.uv0[i as usize]);
            // v points down, so a counter-clockwise triangle is clockwise in (u, v).
            assert!((b - a).perp_dot(c - a) < 0.0, "{shape:?}: {a} {b} {c}");
        }
    }
}

mod areas;
mod boolean;
mod displaced;
mod outlined;
mod tangents;
mod text;
mod work;
