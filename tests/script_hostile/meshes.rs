//! Meshes that scripts make: right ones arrive as they are, wrong ones are refused where they are written.

use reflet::scene::desc::{ModelSource, ShapeDesc};

use super::{folder, load};
use crate::common::cases;

/// A script whose `setup` returns a mesh of these keys, on lines 2 to 5.
fn script(before: &str, keys: &str) -> String {
    format!(
        "fn setup(ctx) {{\nlet i = []; {before}\n#{{ models: #{{ m: #{{ shape: #{{ kind: \"mesh\",\n{keys} }} }} }},\n\
         instances: [#{{ model: \"m\" }}] }}\n}}"
    )
}

const TRIANGLE: &str = "let p = floats(); p.add(0, 0, 0); p.add(1.5, 0, 0); p.add(0, 1, 0);\
                        let i = floats(); i.add(0, 1, 2);";

#[test]
fn numbers_of_a_mesh_arrive_as_they_are() {
    let folder = folder("meshes");
    let text = script(
        TRIANGLE,
        "positions: p, indices: i, colors: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
    );
    let scene = load(&folder, &text).expect("it is right");
    let ModelSource::Shape(ShapeDesc::Mesh {
        positions,
        indices,
        colors,
        uv,
        ..
    }) = &scene.models.last().expect("a model").value.source
    else {
        panic!("no mesh");
    };
    assert_eq!(**positions, [0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(**indices, [0.0, 1.0, 2.0]);
    assert_eq!((colors.len(), uv.len()), (9, 0));
}

#[test]
fn wrong_meshes_are_refused_where_they_are_written() {
    let folder = folder("wrong-meshes");
    for (body, says) in cases(include_str!("meshes/wrong_meshes.txt")) {
        let (keys, before) = body.split_once('\n').unwrap_or((body, TRIANGLE));
        let text = script(before, keys);
        let error = load(&folder, &text).expect_err(keys);
        assert!(error.contains(says), "{before} {keys}: {error}");
        // Numbers are not shown by the million.
        assert!(error.len() < 1000, "{} bytes", error.len());
    }
}

/// A million numbers are fewer operations than a call has.
#[test]
fn a_million_numbers_pass() {
    let folder = folder("million");
    let text = script(
        "let p = floats(); for i in 0..333_334 { p.add(i, 0.5, -1); }\
         let i = floats(); for k in 0..333_332 { i.add(k, k + 1, k + 2); }",
        "positions: p, indices: i",
    );
    let scene = load(&folder, &text).expect("it is right");
    let ModelSource::Shape(ShapeDesc::Mesh { positions, .. }) =
        &scene.models.last().expect("a model").value.source
    else {
        panic!("no mesh");
    };
    assert_eq!(
        (positions.len(), positions[999_999]),
        (1_000_002, 333_333.0)
    );
}

#[test]
fn many_models_of_the_same_numbers_are_too_much_text() {
    let folder = folder("many-meshes");
    let script = include_str!("meshes/many_models_of_the_same_numbers_are_too_much_text.rhai");
    let message = load(&folder, script).expect_err("it is too much");
    assert!(message.contains("more than 256 MiB"), "{message}");
}
