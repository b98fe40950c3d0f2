//! Tests of the timeline: time, and the panel without a window.

use eframe::egui::accesskit::Role;
use egui_kittest::{Harness, kittest::Queryable as _};

use super::*;
use crate::{
    viewer::{keys, timeline::follow},
    window::ui::keys::presses,
};
use reflet_scene::desc::TimelineDesc;

struct State {
    timeline: Timeline,
    now_s: f64,
    shown: Option<u32>,
    is_stuck: bool,
}

fn timeline_harness<'a>() -> Harness<'a, State> {
    let draw = |ui: &mut Ui, state: &mut State| {
        for press in keys::presses() {
            for _ in 0..presses(ui, press) {
                state.timeline.press(press.action, state.now_s);
            }
        }
        state.timeline.tick(state.now_s);
        let (shown, is_stuck) = (state.shown, state.is_stuck);
        super::panel(ui, &mut state.timeline, shown, is_stuck, state.now_s);
    };
    let state = State {
        timeline: timeline(24.0, 2, 11),
        now_s: 0.0,
        shown: None,
        is_stuck: false,
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
    // The picture is late: the frame that it shows is stated.
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
fn distinguishes_the_failed_frame_from_the_shown_one() {
    let mut harness = timeline_harness();
    harness.state_mut().timeline.seek(9, 0.0);
    harness.state_mut().shown = Some(9);
    harness.run();
    click(&mut harness, ">");
    let text = "frame 9 shown, 10 wanted";
    assert!(harness.query_by_label(text).is_none(), "it is being drawn");
    harness.state_mut().is_stuck = true;
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
    // A slow window gets several key presses in one frame.
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

fn timeline(fps: f32, start: u32, end: u32) -> Timeline {
    Timeline::new(&TimelineDesc { fps, start, end })
}

#[test]
fn playback_follows_the_clock_and_drops_late_frames() {
    let mut time = timeline(24.0, 10, 19);
    assert_eq!(time.tick(5.0), None, "paused");
    time.toggle(100.0);
    let wait = time.tick(100.0).expect("plays");
    assert!(time.frame() == 10 && (wait - 1.0 / 24.0).abs() < 1e-9);
    time.tick(100.0 + 4.5 / 24.0);
    assert_eq!(time.frame(), 14);
    // The time of one wrap around the end, and of many rounds later.
    time.tick(100.0 + 10.5 / 24.0);
    assert_eq!(time.frame(), 10);
    time.tick(100.0 + 1e6 / 24.0 + 1e-6);
    assert_eq!(time.frame(), 10);
    time.repeats = false;
    time.seek(18, 200.0);
    assert!(time.is_playing());
    assert_eq!(time.tick(201.0), None);
    assert!(time.frame() == 19 && !time.is_playing());
    time.toggle(300.0);
    assert_eq!(time.frame(), 10, "plays from the start");
}

#[test]
fn steps_pause_and_keep_to_the_timeline() {
    let mut time = timeline(10.0, 0, 3);
    time.toggle(0.0);
    time.step(1);
    assert!(time.frame() == 1 && !time.is_playing());
    time.step(-2);
    assert_eq!(time.frame(), 3, "around");
    time.repeats = false;
    time.step(1);
    assert_eq!(time.frame(), 3);
    time.seek(99, 0.0);
    assert_eq!(time.frame(), 3);
    let one = timeline(10.0, 7, 7);
    assert_eq!(one.after(7, 5), (7, false));
}

#[test]
fn another_timeline_keeps_frame_pause_and_loop() {
    let mut time = timeline(24.0, 0, 100);
    time.repeats = false;
    time.seek(80, 0.0);
    let desc = |fps, end| TimelineDesc { fps, start: 0, end };
    time.replace(&desc(12.0, 90), 1.0);
    assert!(time.frame() == 80 && !time.is_playing() && !time.repeats);
    time.toggle(10.0);
    time.tick(10.25);
    assert_eq!(time.frame(), 83);
    // The new rate counts from now on; the time played so far stays.
    time.replace(&desc(24.0, 90), 10.25);
    time.tick(10.5);
    assert_eq!(time.frame(), 89);
    time.replace(&desc(24.0, 50), 10.5);
    assert!(time.frame() == 50 && time.is_playing());
}

#[test]
fn restored_timeline_keeps_its_frame() {
    let desc = |end| TimelineDesc {
        fps: 24.0,
        start: 0,
        end,
    };
    let (mut shown, mut hidden_timeline) = (Some(timeline(24.0, 0, 100)), None);
    let time = shown.as_mut().expect("is there");
    time.repeats = false;
    time.seek(40, 0.0);
    time.toggle(0.0);
    time.tick(0.5);
    follow(&mut shown, &mut hidden_timeline, None, 0.5);
    follow(&mut shown, &mut hidden_timeline, None, 5.0);
    assert!(shown.is_none());
    // The seconds without a timeline do not count.
    follow(&mut shown, &mut hidden_timeline, Some(&desc(100)), 90.0);
    let time = shown.as_mut().expect("is back");
    time.tick(90.0);
    assert!(time.frame() == 52 && time.is_playing() && !time.repeats);
    time.toggle(90.0);
    follow(&mut shown, &mut hidden_timeline, None, 91.0);
    follow(&mut shown, &mut hidden_timeline, Some(&desc(30)), 92.0);
    let time = shown.as_ref().expect("is back");
    assert!(time.frame() == 30 && !time.is_playing() && !time.repeats);
}

#[test]
fn reports_dropped_frames() {
    let mut time = timeline(20.0, 0, 100);
    time.toggle(0.0);
    for i in 1..=60 {
        time.count(f64::from(i) / 20.0);
    }
    assert_eq!(time.pace(3.0), "20 fps");
    for i in 1..=10 {
        time.count(3.0 + f64::from(i) / 5.0);
    }
    assert_eq!(time.pace(5.0), "5.0 of 20 fps: frames are dropped");
    // Also while the first frame is still being drawn.
    assert_eq!(time.pace(9.0), "0.0 of 20 fps: frames are dropped");
    time.toggle(9.0);
    assert_eq!(time.pace(9.0), "20 fps");
}
