//! Failing scripts and invalid saves keep the last good scene.

use reflet::runtime::SessionError;

use crate::{
    kit::*,
    scripts::{SCRIPT, Session},
};

#[test]
fn an_error_in_a_frame_keeps_the_last_good_one() {
    let mut session = or_skip!(Session::new());
    let failing = SCRIPT.replace(
        "fn frame(ctx) {\n",
        "fn frame(ctx) {\n    if ctx.frame > 9 { throw \"too late\"; }\n",
    );
    assert!(session.save_script(&failing).ok);
    session.live.pose_now(5);
    let good = session.picture();
    assert!(!session.live.pose_now(12));
    assert_eq!(session.place(), "move.rhai:10");
    let message = &session.live.problems.pose[0].message;
    assert!(message.contains("too late") && message.contains("in frame 12"));
    assert!(session.live.scene().frame == 5 && session.picture() == good);
    assert!(session.live.pose_now(5) && session.live.problems.is_empty());
}

#[test]
fn a_save_that_fails_in_the_wanted_frame_is_shown_from_the_next_good_frame_on() {
    let mut session = or_skip!(Session::new());
    let failing = SCRIPT.replace("vec3(i - 1", "vec3(i - 2").replace(
        "fn frame(ctx) {\n",
        "fn frame(ctx) {\n    if ctx.frame > 9 { throw \"too late\"; }\n    \
         ctx.light(\"lamp\", #{ color: [1, 0, 0] });\n",
    );
    session.live.pose_now(12);
    let good = session.picture();
    assert!(!session.save_script(&failing).ok);
    assert_eq!(session.place(), "move.rhai:10");
    assert!(session.live.problems.scene.is_empty(), "the text is right");
    assert!(session.live.scene().frame == 12 && session.picture() == good);
    // Other failing frames change only the message.
    assert!(!session.live.pose_now(20) && session.picture() == good);
    assert!(
        session.live.problems.pose[0]
            .message
            .contains("in frame 20")
    );
    assert!(session.live.pose_now(5) && session.live.problems.is_empty());
    let new = session.picture();
    assert!(new != good && new == session.afresh(5, &[]));
    // Now the new scene is shown.
    assert!(!session.live.pose_now(12) && session.picture() == new);
    // A pending scene is dropped by the next save, also an invalid one.
    assert!(session.save_script(SCRIPT).ok && session.live.pose_now(12));
    assert!(session.picture() == good);
    assert!(!session.save_script(&failing).ok && !session.live.pose_now(20));
    assert!(!session.save_script("fn frame(ctx) {").ok);
    assert!(session.live.problems.pose.is_empty() && session.picture() == good);
    assert!(session.live.pose_now(20) && session.picture() != good);
    assert_eq!(session.live.scene().frame, 20);
    assert!(session.save_script(SCRIPT).ok && session.live.problems.is_empty());
    assert!(session.picture() == session.afresh(20, &[]));
}

#[test]
fn a_save_that_waits_for_a_good_frame_has_its_own_timeline() {
    let mut session = or_skip!(Session::new());
    session.live.pose_now(12);
    let good = session.picture();
    let failing = "fn frame(ctx) { if ctx.frame < 42 { throw \"too early\"; } }";
    let text = fs::read_to_string(&session.scene).expect("readable");
    fs::write(&session.scene, text.replace("end = 40", "end = 41")).expect("written");
    session.live.reload(&[Change::Scene].into());
    let script = SCRIPT.replace("fn frame(ctx) {", &failing.replace("} }", "}"));
    let end = |session: &Session| session.live.timeline().map(|t| t.end);
    assert_eq!(end(&session), Some(41));
    fs::write(&session.scene, text.replace("end = 40", "end = 80")).expect("written");
    assert!(!session.save_script(&script).ok);
    assert_eq!(
        session.live.desc().timeline.as_ref().map(|t| t.end),
        Some(41)
    );
    assert_eq!(
        end(&session),
        Some(80),
        "what is offered is what is on disk"
    );
    assert!(session.picture() == good);
    // The only valid frames are outside of the shown scene's timeline.
    assert!(session.live.pose_now(48) && session.live.problems.is_empty());
    assert_eq!((session.live.scene().frame, end(&session)), (48, Some(80)));
}

#[test]
fn a_scene_that_is_broken_at_first_is_shown_when_it_is_mended() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let path = folder.write(
        "scene.toml",
        SCENE.replace("kind = \"box\"", "kind = \"bx\""),
    );
    let source = source(&path);
    let mistakes = match Live::open(
        gpu.clone(),
        source.clone(),
        ViewOverrides::default(),
        InitialBuild::Whole,
    ) {
        Err(SessionError::Scene(mistakes)) => mistakes,
        other => panic!("{other:?}"),
    };
    let mut live =
        Live::open_empty(gpu.clone(), source, ViewOverrides::default(), mistakes).expect("valid");
    for changes in [[].into(), [Change::Scene].into()] {
        live.reload(&changes);
        assert!(live.problems.scene[0].to_string().contains("bx"));
    }
    assert!(live.world().instances.is_empty());
    assert!(!picture(&gpu, &mut live).is_empty());
    let (list, _) = live.watch_list();
    assert!(
        list.files
            .iter()
            .any(|(path, _)| path.ends_with("scene.toml"))
    );
    let path = folder.write("scene.toml", SCENE);
    assert!(live.reload(&[Change::Scene].into()).ok);
    assert!(live.problems.is_empty() && live.warnings().is_empty());
    let mended = picture(&gpu, &mut live);
    assert!(mended == picture(&gpu, &mut open(&gpu, &path, None)));
    folder.write(
        "scene.toml",
        SCENE.replace("[0, 0.5, 0]\n[mat", "[0, 9, 9]\n[mat"),
    );
    assert!(live.reload(&[Change::Scene].into()).ok);
    let names: Vec<_> = live.warnings().iter().map(|w| w.name).collect();
    assert_eq!(
        names,
        ["empty-view"],
        "the picture shows the environment alone"
    );
    let away = open(&gpu, &path, None);
    assert_eq!(away.warnings(), live.warnings());
    folder.write("scene.toml", SCENE);
    assert!(live.reload(&[Change::Scene].into()).ok && live.warnings().is_empty());
}
