//! Tests of poses of nodes and morph targets inside files.

use glam::Vec3;

use super::frame;

#[test]
fn joints_and_morphs_are_those_that_the_scene_lists() {
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
