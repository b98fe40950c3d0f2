//! Meshes that scripts make: right ones arrive as they are, wrong ones are refused where they are written.

use reflet::scene::desc::{ModelSource, ShapeDesc};

use super::{folder, load};

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
    let both = "positions: p, indices: i";
    for (before, keys, says) in [
        (TRIANGLE, "positions: p", "`indices` is missing"),
        (
            TRIANGLE,
            "positions: p, indices: [0, 1, 3]",
            "`indices[2]` must be the number of a vertex, 0 to 2, not 3",
        ),
        (TRIANGLE, "positions: p, indices: [0, 1, 3]", "s.rhai:4:15"),
        (TRIANGLE, "positions: p, indices: [0, 1, 0.5]", "not 0.5"),
        (
            TRIANGLE,
            "positions: p, indices: [0, 1, -1]",
            "`indices[2]` must be 0 or more",
        ),
        (
            TRIANGLE,
            "positions: p, indices: [0, 1]",
            "1 to 2000000 triangles",
        ),
        (
            TRIANGLE,
            "positions: [0, 1, 2], indices: i",
            "3 to 2000000 vertices",
        ),
        (
            TRIANGLE,
            "positions: p, indices: i, uv: [0, 1]",
            "`uv` must be 6 numbers, 2 for each of 3 vertices, not 2",
        ),
        (
            TRIANGLE,
            "positions: p, indices: i, colors: [2, 0, 0, 0, 0, 0, 0, 0, 0]",
            "`colors[0]` must be 0 to 1",
        ),
        (
            TRIANGLE,
            "positions: \"many\", indices: i",
            "in scripts `floats`",
        ),
        (
            "let p = floats(); p.add(0.0 / 0.0);",
            both,
            "finite numbers",
        ),
        ("let p = floats(); p.add(1e300);", both, "s.rhai:2:"),
        (
            "let p = floats(10_000_000);",
            both,
            "0 to 6000000 numbers, not 10000000",
        ),
        (
            "let p = floats(6_000_000); p.add(1);",
            both,
            "at most 6000000 numbers",
        ),
        (
            "let i = floats(3); let p = floats(5_999_999);",
            both,
            "3 to 2000000 vertices, three numbers each, not 5999999 numbers",
        ),
        ("let p = floats(3); p[3] = 1.0;", both, "there is none at 3"),
        ("let p = floats(-1);", both, "not -1"),
        // Ten million vertices from a loop meet the limit of operations or of numbers.
        (
            "let p = floats(); loop { p.add(1, 2, 3); }",
            both,
            "s.rhai:2:",
        ),
    ] {
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
    let script = "fn setup(ctx) {
        let f = floats(3000000);
        let models = #{};
        for i in 0..1000 { models[`m${i}`] = #{ shape: #{ kind: \"mesh\", positions: f, indices: f } }; }
        #{ models: models }
    }";
    let message = load(&folder, script).expect_err("it is too much");
    assert!(message.contains("more than 256 MiB"), "{message}");
}
