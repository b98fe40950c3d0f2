//! Parameter overrides: valid ones persist while they fit the declarations; refused ones change
//! nothing.

use reflet::{
    render::RebuildSummary, runtime::parameters::ParameterOverrides, scene::desc::ParamValue,
};

use crate::{
    kit::*,
    scripts::{SCRIPT, Session},
};

#[test]
fn parameters_are_laid_over_as_set_does_and_stay_as_long_as_they_exist() {
    let mut session = or_skip!(Session::new());
    session.live.pose_now(10);
    let first = session.picture();
    let own = session.live.declared().clone();
    assert_eq!(own[0], ("count".to_owned(), ParamValue::Integer(2)));
    let mut overrides = ParameterOverrides::default();
    overrides.set("count", ParamValue::Integer(3), &own[0].1);
    assert!(session.live.set_parameters_now(overrides.clone()).ok);
    let three = session.picture();
    assert!(three != first && three == session.afresh(10, &["params.count=3"]));
    // A save of the script keeps the override.
    let reload = session.save_script(&format!("{SCRIPT}// saved\n"));
    assert!(reload.ok && reload.rebuilt == RebuildSummary::default());
    assert!(session.picture() == three);
    // A removed parameter loses its override.
    let text = fs::read_to_string(&session.scene).expect("readable");
    fs::write(&session.scene, text.replace("count = 2", "number = 2")).expect("written");
    session.folder.write(
        "sub/move.rhai",
        SCRIPT.replace("ctx.params.count", "ctx.params.number"),
    );
    let reload = session.live.reload(&[Change::Scene, Change::Script].into());
    assert!(reload.ok, "{:?}", session.live.problems);
    assert!(session.live.parameters().is_empty() && session.picture() == first);
}

#[test]
fn values_that_do_not_work_are_refused_and_leave_everything_as_it_was() {
    let mut session = or_skip!(Session::new());
    session.live.pose_now(10);
    let own = session.live.declared()[0].1.clone();
    let overrides = |count| {
        let mut overrides = ParameterOverrides::default();
        overrides.set("count", ParamValue::Integer(count), &own);
        overrides
    };
    assert!(session.live.set_parameters_now(overrides(3)).ok);
    let three = session.picture();
    let refused = |session: &mut Session| {
        let refusal = session.live.refusal().expect("is refused");
        assert!(session.live.problems.is_empty() && *session.live.parameters() == overrides(3));
        assert!(session.picture() == three && refusal.stays == overrides(3));
        refusal
    };
    assert!(session.live.set_parameters_now(overrides(60_000)).ok);
    let refusal = refused(&mut session);
    let value = ("count".to_owned(), ParamValue::Integer(60_000));
    assert_eq!(refusal.values, [value]);
    assert!(!refusal.why.scene.is_empty());
    // The next save does not try the refused values again.
    assert!(session.save_script(&format!("{SCRIPT}// saved\n")).ok);
    assert!(session.live.refusal().is_none() && session.picture() == three);
    // A save together with values that fail only in the requested frame, or before it.
    for place in ["fn frame(ctx) {", "fn setup(ctx) {"] {
        let text = SCRIPT.replace(
            place,
            &format!("{place} if ctx.params.count == 5 {{ throw 5; }}"),
        );
        assert!(text != SCRIPT, "{place}");
        session.live.set_parameters(overrides(5));
        assert!(session.save_script(&text).ok, "{:?}", session.live.problems);
        let why = refused(&mut session).why;
        assert_eq!(why.pose.is_empty(), place.contains("setup"));
    }
    // With invalid scene text the values stay pending.
    let text = fs::read_to_string(&session.scene).expect("readable");
    fs::write(&session.scene, format!("{text}\n[")).expect("written");
    assert!(!session.live.reload(&[Change::Scene].into()).ok);
    assert!(!session.live.set_parameters_now(overrides(4)).ok && session.live.refusal().is_none());
    assert!(!session.live.problems.scene.is_empty() && session.picture() == three);
    fs::write(&session.scene, text).expect("written");
    assert!(session.live.reload(&[Change::Scene].into()).ok);
    assert!(*session.live.parameters() == overrides(4) && session.live.refusal().is_none());
    assert!(session.picture() == session.afresh(10, &["params.count=4"]));
}

#[test]
fn parameters_outlive_a_save_that_fails() {
    let mut session = or_skip!(Session::new());
    let count = session.live.declared()[0].1.clone();
    let mut overrides = ParameterOverrides::default();
    overrides.set("count", ParamValue::Integer(3), &count);
    assert!(session.live.set_parameters_now(overrides.clone()).ok);
    let three = session.picture();
    let text = fs::read_to_string(&session.scene).expect("readable");
    let cut = text.find("[params]").expect("it has parameters");
    for part in ["", &text[..cut]] {
        fs::write(&session.scene, part).expect("written");
        assert!(!session.live.reload(&[Change::Scene].into()).ok, "{part}");
        assert!(*session.live.parameters() == overrides, "{part}");
        assert!(session.picture() == three);
    }
    fs::write(&session.scene, format!("{text}# saved\n")).expect("written");
    assert!(session.live.reload(&[Change::Scene].into()).ok);
    assert!(*session.live.parameters() == overrides && session.picture() == three);
}
