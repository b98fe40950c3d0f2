//! Shapes are closed, right way round, and near their closed forms.

use std::{collections::HashMap, f64::consts::PI, path::Path};

use glam::DVec3;

use super::*;
use reflet_scene::{desc::ModelSource, stages::Scene};

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

/// Supplies in which the name of each file is its content.
fn supplies(shape: &ShapeDesc) -> Supplies {
    let files = shape.files().into_iter().map(|named| &named.file);
    Supplies {
        files: files.map(|f| (f.clone(), f.clone().into_bytes())).collect(),
        ..Supplies::default()
    }
}

fn mesh(shape: &ShapeDesc) -> Mesh {
    make(shape, &supplies(shape)).expect("a shape").mesh
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

/// Lines of a file of cases, each with its outcome.
fn cases(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let lines = text
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| line.split_once(" => ").expect(line))
}

#[test]
fn shapes_have_their_closed_forms() {
    for (case, outcome) in cases(include_str!("tests/closed_forms.txt")) {
        let (edges, shape) = case.split_once(' ').expect(case);
        let mesh = mesh(&read(shape));
        match edges {
            "closed" => check_closed(&mesh, shape),
            "joined" => check_joined(&mesh, shape),
            rim => {
                assert_eq!(open_edges(&mesh).to_string(), rim, "{shape}");
                check_texture(&mesh, shape);
            }
        }
        let outcome = outcome.split('#').next().unwrap_or_default();
        let numbers = outcome.split_whitespace().filter(|word| *word != "y");
        let numbers: Vec<Option<f64>> = numbers.map(|number| number.parse().ok()).collect();
        let (area, volume) = area_and_volume(&mesh);
        for (found, expected) in [area, volume].into_iter().zip(&numbers) {
            let off = expected.map_or(0.0, |expected| (found / expected - 1.0).abs());
            let tolerance = numbers[2].expect("a tolerance");
            assert!(off < tolerance, "{found}, not {expected:?}: {shape}");
        }
        if let [_, _, _, low, high] = numbers[..] {
            let bounds = [mesh.bounds.min.y, mesh.bounds.max.y].map(|y| Some(y.into()));
            assert_eq!(bounds, [low, high], "{shape}");
        }
    }
}

#[test]
fn wrong_shapes_are_refused_and_doubtful_ones_told() {
    for (shape, expected) in cases(include_str!("tests/refused.txt")) {
        let read = read(shape);
        let said = match make(&read, &supplies(&read)) {
            Err(fault) => format!("error {}: {}", fault.name, fault.message),
            Ok(made) => match made.warnings.first() {
                Some(warning) => format!("warning {}", warning.name),
                None => "no warning".to_owned(),
            },
        };
        let is_said = |part: &str| said.contains(part);
        assert!(expected.split(" … ").all(is_said), "{said}: {shape}");
    }
}

/// Checks that each edge belongs to two triangles, once in each direction, and that normals and texture coordinates fit
/// the triangles.
fn check_closed(mesh: &Mesh, shape: &str) {
    let mut edges: HashMap<_, [u32; 2]> = HashMap::new();
    for [a, b, c] in corners(mesh) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
            let (from, to) = (key(from), key(to));
            let ends = if from < to { (from, to) } else { (to, from) };
            edges.entry(ends).or_default()[usize::from(from < to)] += 1;
        }
    }
    let odd = edges.values().filter(|uses| **uses != [1, 1]).count();
    assert_eq!(odd, 0, "of {} edges of {shape}", edges.len());
    let count = mesh.positions.len();
    assert_eq!([mesh.normals.len(), mesh.uv0.len()], [count; 2], "{shape}");
    for (normal, uv) in mesh.normals.iter().zip(&mesh.uv0) {
        assert!((normal.length() - 1.0).abs() < 1e-5, "{shape}");
        assert!(uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all());
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let face = (b - a).cross(c - a).normalize_or_zero();
        let agrees = triangle.map(|i| mesh.normals[i as usize].dot(face));
        assert!(agrees.iter().all(|x| *x > 0.3), "{shape}: {agrees:?}");
    }
    check_texture(mesh, shape);
}

/// Checks that the texture is not mirrored seen from outside: v points down, so that triangles turn with the clock. Where
/// triangles meet in a pole, some have no area in the texture.
fn check_texture(mesh: &Mesh, shape: &str) {
    let mut area = 0.0;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.uv0[i as usize].as_dvec2());
        let turned = (b - a).perp_dot(c - a);
        assert!(turned < 1e-9, "{shape}: {a} {b} {c}");
        area -= turned;
    }
    assert!(area > 1e-3, "{shape}: {area}");
}

/// Checks that no edge is open, and that normals point out of their triangles; the faces of slivers are not known better
/// than their corners.
fn check_joined(mesh: &Mesh, shape: &str) {
    assert_eq!(open_edges(mesh), 0, "{shape}");
    for (triangle, [a, b, c]) in mesh.triangles.iter().zip(corners(mesh)) {
        let face = (b - a).cross(c - a);
        let normals = triangle.map(|i| mesh.normals[i as usize].as_dvec3());
        let agrees = face.length() < 1e-6 || normals.iter().sum::<DVec3>().dot(face) > 0.0;
        assert!(agrees, "{shape}: {face}");
    }
}

#[test]
fn outlines_turned_are_smooth_where_they_bend_little() {
    let points = "[[0.5, 0.0], [0.5, 1.0], [0.45, 2.0], [0.2, 2.0]]";
    let mesh = mesh(&read(&format!(
        r#"{{ kind = "lathe", points = {points} }}"#
    )));
    let at = |y: f32, x: f32| {
        let near = |p: &Vec3| (p.y - y).abs() < 1e-6 && (p.z - x).abs() < 1e-6;
        let all = mesh.positions.iter().zip(&mesh.normals);
        let mut found: Vec<_> = all.filter(|(p, _)| near(p)).map(|(_, n)| *n).collect();
        found.dedup_by(|a, b| a.distance(*b) < 1e-6);
        found.len()
    };
    assert_eq!((at(1.0, 0.5), at(2.0, 0.45)), (1, 2));
}

mod boolean;
mod displaced;
mod outlined;
mod tangents;
mod text;
mod work;
