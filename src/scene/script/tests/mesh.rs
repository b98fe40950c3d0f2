//! Tests of meshes that `frame` deforms.

use super::{assert_refused, frame};

#[test]
fn only_vertices_that_the_mesh_has_can_be_moved() {
    for (body, says) in [
        (
            "ctx.mesh(\"flag\", floats(12))",
            "must be 9 numbers, 3 for each of its 3 vertices, not 12 numbers (4 vertices)",
        ),
        (
            "ctx.mesh(\"flag\", floats(9), floats(6))",
            "the normals of model \"flag\" must be 9 numbers",
        ),
        ("ctx.mesh(\"flga\", floats(9))", "did you mean \"flag\"?"),
        (
            "ctx.mesh(\"ball\", floats(9))",
            "its shape must be of `kind = \"mesh\"` with `dynamic = true`",
        ),
        (
            "ctx.mesh(\"flag\", [0, 0, 0])",
            "must be `floats`, not an array",
        ),
        (
            "let p = floats(9); p[0] = 0.0 / 0.0; ctx.mesh(\"flag\", p)",
            "finite",
        ),
        (
            "let p = floats(9); p[4] = 1e20; ctx.mesh(\"flag\", p)",
            "number 4 is 1000000",
        ),
    ] {
        assert_refused(body, says);
    }
}

#[test]
fn the_last_vertices_of_a_frame_are_those_at_the_call() {
    let script = "fn frame(ctx) {
        let p = floats(9);
        ctx.mesh(\"flag\", p);
        p[1] = 2.5;
        ctx.mesh(\"flag\", p, p);
        p[1] = 7.0;
    }";
    let state = frame(script).expect("it runs");
    let (_, pose) = state.meshes.first_key_value().expect("one mesh");
    assert_eq!(pose.positions[..3], [0.0, 2.5, 0.0]);
    assert_eq!(pose.normals.as_ref().map(|n| n.len()), Some(9));
}
