//! The panels without a window: clicks and what they ask for, mistakes and where they point.

use std::{collections::VecDeque, path::Path};

use eframe::egui;
use egui_kittest::{Harness, kittest::Queryable as _};

use super::*;
use crate::{
    app::{
        live::Problems,
        preview::{
            facts::Row,
            messages::{help, place_of, problems},
        },
    },
    math::Bounds,
    render::stats::Shares,
    scene::{desc::CameraDesc, parse},
};

fn facts() -> Facts {
    let row = |material, name: &str| Row {
        name: name.to_owned(),
        edit: Edit {
            material,
            reflectivity: 0.25,
            roughness: 0.5,
            metallic: 0.0,
        },
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
}

fn harness<'a>(draw: impl Fn(&mut egui::Ui, &mut State) + 'a) -> Harness<'a, State> {
    let state = State {
        choice: Choice::new(Method::Hybrid),
        facts: facts(),
        wishes: Vec::new(),
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
fn a_selected_material_shows_its_numbers() {
    let mut harness = harness(|ui, state| {
        materials(ui, &mut state.choice, &state.facts, &mut state.wishes);
    });
    assert!(harness.query_by_label("reflectivity").is_none());
    click(&mut harness, "chrome  ×2");
    assert_eq!(harness.state().choice.material, Some(1));
    assert!(harness.query_all_by_label("reflectivity").count() > 0);
    assert!(harness.state().wishes.is_empty(), "looking changes nothing");
    click(&mut harness, "chrome  ×2");
    assert_eq!(harness.state().choice.material, None);
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
    for label in ["30.0 % of the picture reflects", "ssr", "hit", "F12"] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
}
