//! The panels without a window: clicks and what they ask for, mistakes and where they point.

use std::{collections::VecDeque, path::Path};

use eframe::egui::{self, accesskit::Role};
use egui_kittest::{Harness, kittest::Queryable as _};

use super::*;
use crate::{
    app::{
        live::Problems,
        preview::{
            facts::Row,
            messages::{Doing, help, log, place_of, problems, status},
            timeline::{self, Timeline},
            tuning,
        },
    },
    math::Bounds,
    render::stats::Shares,
    scene::{
        desc::{CameraDesc, MaterialDesc, ParamValue, TimelineDesc},
        diagnostic::Diagnostic,
        parse,
    },
};

pub fn facts() -> Facts {
    let row = |material, name: &str| Row {
        name: name.to_owned(),
        numbers: MaterialDesc::default(),
        edit: Edit::new(material),
        uses: 2,
        bounds: Bounds::EMPTY,
    };
    Facts {
        timeline: None,
        declared: Vec::new(),
        log: Vec::new(),
        cameras: vec![
            ("main".to_owned(), CameraDesc::default()),
            ("side".to_owned(), CameraDesc::default()),
        ],
        materials: vec![row(0, "floor"), row(1, "chrome")],
        casters: Vec::new(),
        bounds: Bounds::EMPTY,
        method: Method::Hybrid,
        unit_m: 1.0,
        dropped: vec!["checkers: no material has one".to_owned()],
        problems: Problems::default(),
        warnings: Vec::new(),
    }
}

struct State {
    choice: Choice,
    facts: Facts,
    wishes: Vec<Wish>,
    timeline: Timeline,
    tuned: Tuned,
    now_s: f64,
    shown: Option<u32>,
}

fn harness<'a>(draw: impl Fn(&mut egui::Ui, &mut State) + 'a) -> Harness<'a, State> {
    let state = State {
        choice: Choice::new(Method::Hybrid),
        facts: facts(),
        wishes: Vec::new(),
        timeline: Timeline::new(&TimelineDesc {
            fps: 24.0,
            start: 2,
            end: 11,
        }),
        tuned: Tuned::default(),
        now_s: 0.0,
        shown: None,
    };
    Harness::builder()
        .with_size(egui::vec2(1000.0, 700.0))
        .build_ui_state(draw, state)
}

fn click(harness: &mut Harness<'_, State>, label: &str) {
    harness.get_by_label(label).click();
    harness.run();
}

#[test]
fn the_bar_switches_methods_and_opens_the_wipe() {
    let mut harness = harness(|ui, state| {
        bar(ui, &mut state.choice, &state.facts, &mut state.wishes);
    });
    click(&mut harness, "ssr");
    assert_eq!(harness.state().choice.a.method, Method::Ssr);
    assert!(harness.query_all_by_label("ssr").count() == 1);
    click(&mut harness, "wipe");
    assert!(harness.state().choice.wipe);
    assert_eq!(harness.query_all_by_label("ssr").count(), 2, "a side each");
    for (label, wish) in [
        ("frame", Wish::Frame),
        ("copy camera", Wish::Copy),
        ("error", Wish::Judge),
        ("screenshot", Wish::Shot),
    ] {
        click(&mut harness, label);
        assert_eq!(harness.state_mut().wishes.pop(), Some(wish), "{label}");
    }
}

#[test]
fn mistakes_show_their_place() {
    let text = "version = 1\n[camera.main]\neye = [0, 1]\n";
    let errors = parse::parse(text, Path::new("my.toml"), &[]).expect_err("a mistake");
    let place = place_of(&errors[0]).expect("has a place");
    assert!(place.starts_with("my.toml:3:"), "{place}");
    let mut harness = harness(|ui, state| problems(ui, &state.facts.problems));
    harness.state_mut().facts.problems.scene = errors;
    harness.run();
    assert!(harness.query_by_label(&place).is_some());
}

#[test]
fn times_shares_and_keys_are_listed() {
    let mut counters = [0; 16];
    counters[1] = 30;
    let stats = FrameStats {
        size: [10, 10],
        samples: 1,
        method: Method::Hybrid,
        unit_m: 1.0,
        tree_ms: 0.0,
        passes_ms: vec![("ssr".to_owned(), 1.25)],
        frame_ms: 2.5,
        shares: Shares::new(&counters, [10, 10], crate::scene::desc::Method::Hybrid),
        rays: 0,
        bytes: Vec::new(),
    };
    let history = VecDeque::from([stats.clone(), stats.clone()]);
    let harness = harness(move |ui, _| {
        shares(ui, &stats, &history);
        times(ui, &stats, &history);
        help(ui);
    });
    for label in [
        "30.0 % of the picture reflects; of that, in %:",
        "ssr",
        "hit",
        "F12",
    ] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
}

fn timeline_harness<'a>() -> Harness<'a, State> {
    harness(|ui, state| {
        let presses = |key| ui.input(|i| i.num_presses(key));
        timeline::keys(&mut state.timeline, presses, state.now_s);
        state.timeline.tick(state.now_s);
        let is_stuck = !state.facts.problems.pose.is_empty();
        timeline::panel(ui, &mut state.timeline, state.shown, is_stuck, state.now_s);
    })
}

#[test]
fn the_timeline_plays_steps_and_scrubs() {
    let mut harness = timeline_harness();
    for label in ["play", "of 11", "24 fps", "loop"] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
    click(&mut harness, "play");
    assert!(harness.state().timeline.is_playing());
    harness.state_mut().now_s = 0.25;
    harness.run();
    assert_eq!(harness.state().timeline.frame(), 8);
    assert!(harness.query_by_label("  0.333 s").is_some());
    // The picture is late: its own frame is told.
    harness.state_mut().shown = Some(6);
    harness.run();
    assert!(harness.query_by_label("  0.250 s").is_some());
    assert_eq!(harness.state().timeline.frame(), 8);
    click(&mut harness, "pause");
    harness.state_mut().now_s = 9.0;
    harness.run();
    assert_eq!(harness.state().timeline.frame(), 8, "paused");
    for (label, frame) in [(">", 9), ("<", 8), (">|", 11), ("|<", 2)] {
        click(&mut harness, label);
        assert_eq!(harness.state().timeline.frame(), frame, "{label}");
    }
    harness.get_by_role(Role::Slider).set_value_accesskit(5.0);
    harness.run();
    assert_eq!(harness.state().timeline.frame(), 5, "scrubbed");
    click(&mut harness, "loop");
    assert!(!harness.state().timeline.repeats);
}

#[test]
fn a_frame_that_cannot_be_posed_is_told_apart_from_the_one_that_is_shown() {
    let mut harness = timeline_harness();
    harness.state_mut().timeline.seek(9, 0.0);
    harness.state_mut().shown = Some(9);
    harness.run();
    click(&mut harness, ">");
    let text = "frame 9 shown, 10 wanted";
    assert!(harness.query_by_label(text).is_none(), "it is being drawn");
    let wrong = Diagnostic::in_file("script", Path::new("a.rhai"), "no");
    harness.state_mut().facts.problems.pose = vec![wrong];
    harness.run();
    harness.get_by_label(text);
    harness.get_by_label("  0.375 s");
    click(&mut harness, "<");
    assert!(harness.query_by_label(text).is_none(), "back where it was");
}

#[test]
fn keys_move_time() {
    use egui::Key;
    let mut harness = timeline_harness();
    for (key, frame) in [
        (Key::End, 11),
        (Key::ArrowRight, 2),
        (Key::ArrowLeft, 11),
        (Key::Home, 2),
    ] {
        harness.key_press(key);
        harness.run();
        assert_eq!(harness.state().timeline.frame(), frame, "{key:?}");
    }
    // A slow window gets several at once.
    for key in [
        Key::ArrowRight,
        Key::ArrowRight,
        Key::ArrowLeft,
        Key::ArrowRight,
    ] {
        harness.key_press(key);
    }
    harness.run();
    assert_eq!(harness.state().timeline.frame(), 4);
    harness.key_press(Key::L);
    harness.key_press(Key::Space);
    harness.run();
    let timeline = &harness.state().timeline;
    assert!(timeline.is_playing() && !timeline.repeats);
}

#[test]
fn each_kind_of_parameter_has_its_control_and_reset_takes_all_back() {
    let mut harness = harness(|ui, state| {
        let mut tuned = state.tuned.clone();
        if tuning::params(ui, &state.facts.declared, &mut tuned) {
            state.wishes.push(Wish::Tune(tuned.clone()));
            state.tuned = tuned;
        }
    });
    assert!(harness.query_by_label("Script parameters").is_none());
    let declared = [
        ("count", ParamValue::Integer(31)),
        ("speed", ParamValue::Number(0.5)),
        ("night", ParamValue::Switch(false)),
        ("word", ParamValue::Text("walk".into())),
        ("at", ParamValue::Numbers(vec![1.0, -2.0])),
    ];
    let declared = declared.map(|(name, value)| (name.to_owned(), value));
    harness.state_mut().facts.declared = declared.into();
    harness.run();
    assert!(harness.state().wishes.is_empty(), "looking changes nothing");
    click(&mut harness, "night");
    let field = harness.get_by_role(Role::TextInput);
    field.focus();
    field.type_text("er");
    harness.run();
    let count = harness.get_all_by_role(Role::Slider).next();
    count.expect("a slider").set_value_accesskit(62.0);
    harness.run();
    let settings = harness.state().tuned.settings();
    assert_eq!(settings.len(), 3, "{settings:?}");
    assert!(
        settings.contains(&"params.night=true".to_owned()),
        "{settings:?}"
    );
    assert!(
        settings.contains(&"params.count=62".to_owned()),
        "{settings:?}"
    );
    let last = harness.state().wishes.last().cloned();
    assert_eq!(last, Some(Wish::Tune(harness.state().tuned.clone())));
    click(&mut harness, "reset");
    assert!(harness.state().tuned.is_empty());
}

#[test]
fn what_a_script_prints_is_listed() {
    let mut harness = harness(|ui, state| log(ui, &state.facts.log));
    assert!(harness.query_by_label("Script output").is_none());
    harness.state_mut().facts.log = vec!["three figures".to_owned()];
    harness.run();
    click(&mut harness, "Script output");
    assert!(harness.query_by_label("three figures").is_some());
}

#[test]
fn the_status_tells_a_script_that_runs_beside_what_is_drawn() {
    let mut harness = harness(|ui, state| {
        let script_s = (state.now_s > 0.0).then_some(state.now_s);
        let doing = match state.shown {
            None => Doing::Draws,
            Some(_) => Doing::Rests,
        };
        status(ui, 7, &doing, script_s, "saved");
    });
    harness.get_by_label("drawing after picture 7 …");
    harness.get_by_label("saved");
    assert!(harness.query_by_label_contains("script").is_none());
    (harness.state_mut().now_s, harness.state_mut().shown) = (3.24, Some(0));
    harness.run();
    harness.get_by_label("script running 3.2 s");
    harness.get_by_label("still: nothing changed since picture 7");
}

#[test]
fn the_scale_of_the_heat_map_says_what_its_ends_mean() {
    let harness = Harness::new_ui(super::plot::heat_scale);
    for text in ["0: the same", "FLIP 0.5", "1: most"] {
        harness.get_by_label(text);
    }
}
