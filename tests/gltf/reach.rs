//! Geometry so far away that the boxes of trees overflow is refused by name.

use crate::kit::*;

/// A triangle whose first corner has this x.
fn triangle(x: f32) -> Doc {
    let mut doc = Doc::empty();
    let positions = doc.floats("VEC3", &[x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    doc.show(json!({"attributes": {"POSITION": positions}}));
    doc
}

/// Adds a morph target that moves the first corner along x, animated from 0 to 1.
fn morphed(mut doc: Doc, x: f32) -> Doc {
    let offsets = doc.floats("VEC3", &[x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    doc.primitive("targets", json!([{"POSITION": offsets}]));
    doc.json["meshes"][0]["weights"] = json!([0.0]);
    let times = doc.floats("SCALAR", &[0.0, 1.0]);
    let weights = doc.floats("SCALAR", &[0.0, 1.0]);
    doc.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
        "samplers": [{"input": times, "output": weights}]
    }]);
    doc
}

#[test]
fn vertices_too_far_away_are_named() {
    for x in [3e38, -3e38, 2e15] {
        for doc in [triangle(x), morphed(triangle(x), 1.0)] {
            let (name, message) = doc.error();
            assert_eq!(name, "too-far", "{message}");
            assert_says(&message, &["mesh 0", "vertex 0"]);
        }
    }
    assert!(triangle(9e14).load().is_ok());
    assert!(morphed(triangle(9e14), 1.0).load().is_ok());
}

#[test]
fn points_and_lines_too_far_away_are_named() {
    for mode in [0, 1] {
        let mut doc = triangle(3e38);
        doc.primitive("mode", mode.into());
        assert_eq!(doc.error().0, "too-far", "mode {mode}");
    }
}

#[test]
fn poses_at_rest_are_within_reach_too() {
    let mut doc = morphed(triangle(0.0), 3e38);
    doc.json["meshes"][0]["weights"] = json!([1.0]);
    assert_eq!(doc.error().0, "too-far");
    // The same without an animation, where the pose is all that is kept.
    let object = doc.json.as_object_mut().expect("an object");
    object.remove("animations");
    assert_eq!(doc.error().0, "too-far");
}

#[test]
fn instances_too_far_away_are_named() {
    for node in [
        json!({"mesh": 0, "scale": [1e11, 1e11, 1e11]}),
        json!({"mesh": 0, "translation": [0, 3e38, 0]}),
        json!({"mesh": 0, "translation": [0, 2e15, 0]}),
    ] {
        let mut doc = triangle(1e5);
        doc.json["nodes"] = json!([node]);
        let (name, message) = doc.error();
        assert_eq!(name, "too-far", "{message}");
    }
}
