//! Tests of the panels without a window: clicks and the requests they make, errors and their places.

use std::collections::{HashSet, VecDeque};

use eframe::egui::{self, accesskit::Role};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};

use super::*;
use crate::{
    live::{Edit, Problems},
    viewer::scene_summary::MaterialRow,
    window::ui::{
        frame_panels::{shares, times},
        status_bar::{Activity, help, log, status, unwatched},
        status_message::StatusMessage,
    },
};
use reflet_base::math::Bounds;
use reflet_render::{
    pipeline::cause::Source,
    renderer::stats::{Audit, FrameStats, Shares},
};
use reflet_scene::desc::{CameraDesc, MaterialDesc};

pub fn summary() -> SceneSummary {
    let row = |material, name: &str| MaterialRow {
        name: name.to_owned(),
        numbers: MaterialDesc::default(),
        edit: Edit::new(material),
        origin: Some(format!("[material.{name}]")),
        uses: 2,
        bounds: Bounds::EMPTY,
    };
    SceneSummary {
        timeline: None,
        cuts: Vec::new(),
        tracks: Vec::new(),
        declared: Vec::new(),
        log: Vec::new(),
        cameras: (["main", "side"].map(|name| (name.to_owned(), CameraDesc::default()))).into(),
        materials: vec![row(0, "floor"), row(1, "chrome")],
        shadow_lights: Vec::new(),
        items: Vec::new(),
        bounds: Bounds::EMPTY,
        image_size: [1280, 720],
        method: Method::Hybrid,
        unit_m: 1.0,
        dropped: vec!["checkers: no material has one".to_owned()],
        problems: Problems::default(),
        warnings: Vec::new(),
    }
}

struct State {
    settings: ViewSettings,
    summary: SceneSummary,
    requests: Vec<ViewRequest>,
    now_s: f64,
    shown: Option<u32>,
}

fn harness<'a>(draw: impl Fn(&mut egui::Ui, &mut State) + 'a) -> Harness<'a, State> {
    let state = State {
        settings: ViewSettings::new(Method::Hybrid),
        summary: summary(),
        requests: Vec::new(),
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
        bar(ui, &mut state.settings, &state.summary, &mut state.requests);
    });
    let ssr = harness.get_all_by_label("ssr").next();
    ssr.expect("of the left side").click();
    harness.run();
    assert_eq!(harness.state().settings.a.method, Method::Ssr);
    let sides = |harness: &Harness<'_, State>| {
        let all = harness.get_all_by_label("ssr");
        all.filter(|side| !side.accesskit_node().is_disabled())
            .count()
    };
    assert_eq!(sides(&harness), 1);
    // The picture of `auto` was made by `rt`, with which a wipe compares otherwise.
    let settings = &mut harness.state_mut().settings;
    settings.shown_method = Some(Method::Rt);
    (settings.a.method, settings.b.method) = (Method::Auto, Method::Rt);
    click(&mut harness, "wipe");
    assert!(harness.state().settings.wipe);
    assert_eq!(harness.state().settings.b.method, Method::Hybrid);
    assert_eq!(sides(&harness), 2, "a side each");
    for (label, action) in [
        ("frame", KeyAction::Frame),
        ("copy camera", KeyAction::Copy),
        ("error", KeyAction::Compare),
        ("screenshot", KeyAction::Screenshot),
    ] {
        click(&mut harness, label);
        let request = harness.state_mut().requests.pop();
        assert_eq!(request, Some(ViewRequest::Press(action)), "{label}");
    }
}

#[test]
fn a_narrow_bar_keeps_what_belongs_together_and_its_height() {
    // Three rows in narrow windows, else two.
    for (width, most) in [(620.0, 3.0), (900.0, 3.0), (1280.0, 2.5)] {
        let mut harness = harness(move |ui, state| {
            ui.set_max_width(width);
            let before = ui.cursor().top();
            bar(ui, &mut state.settings, &state.summary, &mut state.requests);
            state.now_s = f64::from(ui.cursor().top() - before);
        });
        harness.set_size(egui::vec2(width, 400.0));
        harness.run();
        let rows = harness.state().now_s / 26.0;
        assert!(rows < most, "{width}: {rows} rows");
        let menus = harness.get_all_by_role(Role::ComboBox);
        let menus: Vec<_> = menus.map(|menu| menu.rect()).collect();
        let label = harness.get_by_role_and_label(Role::Label, "camera").rect();
        let camera = menus.last().expect("a menu");
        assert!(camera.left() > label.right() && camera.y_range().contains(label.center().y));
        for menu in menus {
            assert!(menu.right() <= width, "{width}: {menu:?}");
        }
        let before = harness.state().now_s;
        click(&mut harness, "wipe");
        harness.state_mut().settings.scene_camera = Some(1);
        harness.run();
        assert_eq!(harness.state().now_s, before, "{width}: the picture moves");
    }
}

#[test]
fn a_comparison_moves_nothing_below_it() {
    let scores = Scores {
        ssim: Some(0.98765),
        psnr_db: 31.25,
        flip_mean: 0.0123,
        flip_p99: 0.4567,
        ..Scores::default()
    };
    let mut harness = harness(move |ui, state| {
        let comparison = state.shown.map(|_| (Method::Ssr, &scores));
        super::comparison(ui, comparison, state.now_s > 0.0, &mut state.settings);
        ui.label("below");
    });
    harness.run();
    let below = |harness: &Harness<'_, State>| harness.get_by_label("below").rect().top();
    let without = below(&harness);
    harness.get_by_label("X compares this method with rt");
    harness.state_mut().shown = Some(0);
    harness.run();
    assert_eq!(below(&harness), without);
    for text in ["0.9877", "31.2 dB", "0.0123", "0.4567", "ssr, of this view"] {
        harness.get_by_label(text);
    }
    click(&mut harness, "show where (FLIP)");
    assert!(harness.state().settings.error_map);
    harness.state_mut().now_s = 1.0;
    harness.run();
    assert_eq!(below(&harness), without);
}

#[test]
fn panels_list_times_shares_and_keys() {
    let counters = [0, 30, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    let stats = FrameStats {
        size: [10, 10],
        samples: 1,
        method: Method::Hybrid,
        unit_m: 1.0,
        passes_ms: vec![("ssr".to_owned(), 1.25)],
        frame_ms: 2.5,
        shares: Shares::new(&counters, [10, 10], Method::Hybrid),
        audit: Some(Audit {
            hits: 50,
            of: 60,
            wrong: 2,
        }),
        ..FrameStats::default()
    };
    let history = VecDeque::from([stats.clone(), stats.clone()]);
    let harness = harness(move |ui, _| {
        shares(ui, &stats, &history);
        times(ui, &stats, &history);
        help(ui, &mut true);
    });
    for label in [
        "30.0 % of the picture reflects; of that, in %:",
        "ssr",
        "hit",
        "40.0 ‰ of the screen hits are wrong (95 %: 15.7 to 98.4 ‰; 4 of 100 traced)",
        "F12",
    ] {
        assert!(harness.query_by_label(label).is_some(), "{label}");
    }
    let colors: HashSet<_> = (Source::ALL.iter())
        .map(|source| charts::source_color(source.name()))
        .collect();
    assert_eq!(colors.len(), Source::ALL.len(), "two share a color");
}

#[test]
fn what_a_script_prints_is_listed() {
    let mut harness = harness(|ui, state| log(ui, &state.summary.log));
    assert!(harness.query_by_label("Script output").is_none());
    harness.state_mut().summary.log = vec!["three figures".to_owned()];
    harness.run();
    click(&mut harness, "Script output");
    assert!(harness.query_by_label("three figures").is_some());
}

#[test]
fn status_bar_shows_a_background_script() {
    let mut harness = harness(|ui, state| {
        let script_s = (state.now_s > 0.0).then_some(state.now_s);
        let doing = match state.shown {
            None => Activity::Drawing,
            Some(_) => Activity::Idle,
        };
        let mut message = StatusMessage::default();
        message.set("saved");
        status(ui, 7, &doing, script_s, &mut message);
    });
    harness.get_by_label("drawing after picture 7 …");
    harness.get_by_label("saved");
    assert!(harness.query_by_label_contains("script").is_none());
    (harness.state_mut().now_s, harness.state_mut().shown) = (3.24, Some(0));
    harness.run();
    harness.get_by_label("script running 3.2 s");
    harness.get_by_label("picture 7 stays meanwhile");
    assert!(
        harness.query_by_label_contains("idle").is_none(),
        "a script runs"
    );
    harness.state_mut().now_s = 0.0;
    harness.run();
    harness.get_by_label("idle: nothing changed since picture 7");
}

#[test]
fn long_status_message_is_clipped_and_complete_in_its_tooltip() {
    let text = "wrote /a/folder/with/a/long/name/".repeat(6) + "scene-001.png";
    let said = text.clone();
    let mut harness = harness(move |ui, _| {
        ui.set_max_width(500.0);
        let mut message = StatusMessage::default();
        message.set(said.clone());
        status(ui, 7, &Activity::Idle, None, &mut message);
    });
    let message = harness.get_by_label(&text);
    assert!(message.rect().right() <= 508.0, "{:?}", message.rect());
    message.hover();
    harness.run_steps(60); // tooltips appear after a delay
    assert_eq!(harness.query_all_by_label(&text).count(), 2);
}

#[test]
fn every_key_can_be_read_in_a_small_window() {
    let size = egui::vec2(620.0, 420.0);
    let mut harness = harness(|ui, _| help(ui, &mut true));
    harness.set_size(size);
    harness.run();
    let inside = |harness: &Harness<'_, State>, label: &str| {
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
        screen.contains_rect(harness.get_by_label(label).rect())
    };
    assert!(inside(&harness, "left drag") && !inside(&harness, "Ctrl Q"));
    harness.get_by_label("Ctrl Q").scroll_to_me();
    harness.run();
    assert!(inside(&harness, "Ctrl Q") && inside(&harness, "close"));
}

#[test]
fn heat_map_legend_labels_both_ends() {
    let harness = Harness::new_ui(super::charts::flip_scale);
    for text in ["0: the same", "FLIP 0.5", "1: most"] {
        harness.get_by_label(text);
    }
}

#[test]
fn refused_watch_is_shown_while_it_lasts() {
    let why = "the system does not report files saved in /a: raise the limit";
    let mut harness = harness(|ui, _| unwatched(ui, why));
    harness.run();
    assert!(harness.query_by_label(&format!("Saves: {why}")).is_some());
}
