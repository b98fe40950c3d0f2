//! Tests of meshes that `frame` deforms.

use super::frame;

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
