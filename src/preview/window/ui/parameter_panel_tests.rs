//! Tests of the parameter panel without a window: each kind has its control, and refused values are distinguished from
//! values in effect.

use eframe::egui::accesskit::Role;
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};

use super::*;
use crate::live::Problems;
use reflet_scene::diagnostic::Diagnostic;

#[derive(Default)]
struct State {
    declared: DeclaredParameters,
    parameters: Parameters,
    requested: Vec<ParameterOverrides>,
    written: Vec<ParameterOverrides>,
}

fn harness<'a>() -> Harness<'a, State> {
    let draw = |ui: &mut Ui, state: &mut State| {
        if params(ui, &state.declared, &mut state.parameters) {
            state.requested.push(state.parameters.overrides.clone());
        }
        state.written.extend(state.parameters.take_finished(ui));
    };
    Harness::builder()
        .with_size(egui::vec2(320.0, 700.0))
        .build_ui_state(draw, State::default())
}

fn click(harness: &mut Harness<'_, State>, label: &str) {
    harness.get_by_label(label).click();
    harness.run();
}

#[test]
fn each_kind_of_parameter_has_its_control_and_reset_takes_all_back() {
    let mut harness = harness();
    assert!(harness.query_by_label("Script parameters").is_none());
    let declared = [
        ("count", ParamValue::Integer(31)),
        ("speed", ParamValue::Number(0.5)),
        ("night", ParamValue::Switch(false)),
        ("word", ParamValue::Text("walk".into())),
        ("at", ParamValue::Numbers(vec![1.0, -2.0])),
    ];
    let declared = declared.map(|(name, value)| (name.to_owned(), value));
    harness.state_mut().declared = declared.into();
    harness.run();
    assert!(
        harness.state().requested.is_empty(),
        "looking changes nothing"
    );
    click(&mut harness, "night");
    let night = harness.state().parameters.overrides.clone();
    assert_eq!(harness.state().written, [night], "a click is over at once");
    let field = harness.get_by_role(Role::TextInput);
    field.focus();
    field.type_text("er");
    harness.run();
    assert_eq!(harness.state().written.len(), 1, "the word is being typed");
    let count = harness.get_all_by_role(Role::Slider).next();
    count.expect("a slider").set_value_accesskit(62.0);
    harness.run();
    let settings = harness.state().parameters.overrides.settings();
    assert_eq!(settings.len(), 3, "{settings:?}");
    assert!(
        settings.contains(&"params.night=true".to_owned()),
        "{settings:?}"
    );
    assert!(
        settings.contains(&"params.count=62".to_owned()),
        "{settings:?}"
    );
    assert_eq!(
        harness.state().requested.last(),
        Some(&harness.state().parameters.overrides)
    );
    click(&mut harness, "reset");
    assert!(harness.state().parameters.overrides.is_empty());
}

/// Two parameters, the requested values `count = 60` and `speed = 2`, and the overrides before, `stays`.
fn two<'a>() -> (Harness<'a, State>, DeclaredParameters, ParameterOverrides) {
    let declared: DeclaredParameters = vec![
        ("count".to_owned(), ParamValue::Integer(31)),
        ("speed".to_owned(), ParamValue::Number(0.5)),
    ];
    let mut stays = ParameterOverrides::default();
    stays.set("count", ParamValue::Integer(40), &declared[0].1);
    let mut harness = harness();
    let state = harness.state_mut();
    state.declared.clone_from(&declared);
    state.parameters.overrides = stays.clone();
    let set = |parameters: &mut Parameters, name: &str, value| {
        let own = declared.iter().find(|(known, _)| known == name);
        parameters.set(name, value, &own.expect("is declared").1);
    };
    set(&mut state.parameters, "count", ParamValue::Integer(60));
    set(&mut state.parameters, "speed", ParamValue::Number(2.0));
    (harness, declared, stays)
}

fn refusal(value: i64, stays: &ParameterOverrides) -> Refusal {
    let why = Diagnostic::in_file("script", "walk.rhai".as_ref(), "at most 50 fit");
    Refusal {
        values: vec![("count".to_owned(), ParamValue::Integer(value))],
        stays: stays.clone(),
        why: Problems {
            scene: vec![why.help("make the hall longer")],
            ..Problems::default()
        },
    }
}

#[test]
fn a_refused_value_stays_in_its_slider_and_nowhere_else() {
    let (mut harness, declared, stays) = two();
    let state = harness.state_mut();
    state.parameters.refuse(refusal(60, &stays), &declared);
    // The other requested value, `speed`, stays in effect.
    assert_eq!(
        state.parameters.overrides.settings(),
        ["params.speed=2.0", "params.count=40"]
    );
    harness.run();
    let is_marked = |harness: &Harness<'_, State>| {
        let mut marked = harness.query_all_by_label("count (refused)");
        marked.next().is_some()
    };
    assert!(is_marked(&harness));
    for label in [
        "refused: count = 60; the picture has count = 40",
        "at most 50 fit",
        "walk.rhai",
        "help: make the hall longer",
    ] {
        harness.get_by_label(label);
    }
    let slider = harness.get_all_by_role(Role::Slider).next();
    let shown = slider.expect("a slider").accesskit_node().numeric_value();
    assert_eq!(shown, Some(60.0));
    assert!(
        harness.state().requested.is_empty(),
        "marking asks for nothing"
    );
    // Neither a save of the scene nor another parameter's change requests the refused value again.
    harness.state_mut().parameters.keep_what_fits(&declared);
    let speed = harness.get_all_by_role(Role::Slider).last();
    speed.expect("a slider").set_value_accesskit(1.0);
    harness.run();
    let requested = harness.state().requested.last().expect("asks").settings();
    assert_eq!(requested, ["params.count=40", "params.speed=1.0"]);
    assert!(is_marked(&harness));
    click(&mut harness, "try again");
    let requested = harness.state().requested.last().expect("asks").settings();
    assert_eq!(requested, ["params.speed=1.0", "params.count=60"]);
    assert_eq!(harness.query_all_by_label_contains("refused").count(), 0);
}

#[test]
fn a_refused_value_is_taken_back_moved_on_or_reset() {
    let (mut harness, declared, stays) = two();
    let parameters = &mut harness.state_mut().parameters;
    parameters.refuse(refusal(55, &stays), &declared);
    assert!(parameters.refused.is_empty(), "the slider has moved on");
    parameters.refuse(refusal(60, &stays), &declared);
    let marked = parameters.clone();
    harness.run();
    click(&mut harness, "take back");
    assert_eq!(harness.query_all_by_label_contains("refused").count(), 0);
    assert!(harness.state().requested.is_empty(), "it was not in effect");
    harness.state_mut().parameters = marked.clone();
    harness.run();
    let count = harness.get_all_by_role(Role::Slider).next();
    count.expect("a slider").set_value_accesskit(45.0);
    harness.run();
    assert_eq!(harness.query_all_by_label_contains("refused").count(), 0);
    let requested = harness.state().requested.last().expect("asks").settings();
    assert_eq!(requested, ["params.speed=2.0", "params.count=45"]);
    harness.state_mut().parameters = marked.clone();
    harness.run();
    click(&mut harness, "reset");
    assert_eq!(harness.state().parameters, Parameters::default());
    // Written in the scene, it is in effect.
    let mut written = marked;
    written.keep_what_fits(&vec![("count".to_owned(), ParamValue::Integer(60))]);
    assert_eq!(
        written.refused("count"),
        Some(&ParamValue::Integer(60)),
        "over it are 40"
    );
    written.overrides = ParameterOverrides::default();
    written.keep_what_fits(&vec![("count".to_owned(), ParamValue::Integer(60))]);
    assert_eq!(written, Parameters::default());
}
