//! Tests of poses of nodes and morph targets inside files.

use glam::Vec3;

use super::{assert_refused, frame};

#[test]
fn joints_and_morphs_are_those_that_the_scene_lists() {
    for (body, says) in [
        (
            "ctx.joint(\"ball\", \"knee\", #{})",
            "write `joints = [\"knee\"]` in its [[instance]]",
        ),
        (
            "ctx.joint(\"walker\", \"kne\", #{})",
            "did you mean \"knee\"?",
        ),
        (
            "ctx.joint(\"walker\", \"knee\", #{ turns: 1 })",
            "a joint has no `turns`",
        ),
        (
            "ctx.joint(\"walker\", \"knee\", #{ turn: [0, 0.0 / 0.0, 0] })",
            "finite",
        ),
        ("ctx.joint(\"walker\", \"knee\", #{ scale: 0 })", "flatten"),
        ("ctx.morph(\"walker\", \"frown\", 1)", "its `morphs` are"),
        (
            "ctx.morph(\"walker\", \"smile\", \"much\")",
            "must be a number",
        ),
    ] {
        assert_refused(body, says);
    }
    let script = "fn frame(ctx) {
        ctx.joint(\"walker\", \"hip\", #{ turn: [0, 90, 0], translation: [1, 2, 3] });
        ctx.joint(\"walker\", \"hip\", #{ scale: 2 });
        ctx.morph(\"walker\", \"smile\", 0.25);
    }";
    let state = frame(script).expect("it runs");
    let pose = state.joints[&(1, 1)];
    assert_eq!(pose.translation, Some(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!((pose.scale, pose.rotation), (Some(Vec3::splat(2.0)), None));
    assert_eq!(state.morphs, [((1, 0), 0.25)].into());
}
