//! Tests of the keys below the timeline, without a window.

use eframe::egui::{Event, Modifiers, PointerButton, Pos2};
use egui_kittest::{Harness, kittest::Queryable as _};

use super::*;
use reflet_scene::desc::TimelineDesc;

struct State {
    timeline: Timeline,
    keys: Keys,
    requests: Vec<ViewRequest>,
}

fn eye() -> TrackName {
    TrackName {
        kind: "camera",
        name: "main".to_owned(),
        key: "eye",
    }
}

/// A bar of 400 points for 0 to 40 frames, 10 a second, with keys at 0 s, 1 s and 4 s.
fn harness<'a>() -> Harness<'a, State> {
    let draw = |ui: &mut Ui, state: &mut State| {
        let tracks = [KeyTrack {
            track: eye(),
            at_s: vec![0.0, 1.0, 4.0],
        }];
        let State {
            timeline,
            keys,
            requests,
        } = state;
        ui.set_max_width(400.0 + LABEL + 2.0 * HALF + 4.0);
        panel(ui, timeline, 0.0, &tracks, keys, false, requests);
    };
    let desc = TimelineDesc {
        fps: 10.0,
        start: 0,
        end: 40,
    };
    let state = State {
        timeline: Timeline::new(&desc),
        keys: Keys::default(),
        requests: Vec::new(),
    };
    Harness::builder()
        .with_size(vec2(640.0, 120.0))
        .build_ui_state(draw, state)
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    }
}

/// Position of a frame in the row of the track.
fn frame_position(harness: &Harness<'_, State>, frame: f32) -> Pos2 {
    let label = harness.get_by_label("main.eye").rect();
    let plus = harness.get_by_label("+").rect();
    pos2(
        plus.left() + LABEL + HALF + 4.0 + 10.0 * frame,
        label.center().y,
    )
}

fn key(change: KeyChange) -> ViewRequest {
    let track = eye();
    Task::Key(KeyEdit { track, change }).into()
}

#[test]
fn a_key_is_dragged_selected_and_deleted() {
    let mut harness = harness();
    harness.run();
    let (from, to) = (
        frame_position(&harness, 10.0),
        frame_position(&harness, 17.3),
    );
    for event in [
        Event::PointerMoved(from),
        button(from, true),
        Event::PointerMoved(from + vec2(20.0, 0.0)),
        Event::PointerMoved(to),
    ] {
        harness.event(event);
        harness.run();
    }
    assert!(harness.state().requests.is_empty(), "the drag goes on");
    harness.event(button(to, false));
    harness.run();
    // To whole frames, unless times are in seconds.
    let Some(ViewRequest::Task(Task::Key(edit))) = harness.state_mut().requests.pop() else {
        panic!("nothing is written");
    };
    let KeyChange::Move(1, to_s) = edit.change else {
        panic!("{edit:?}");
    };
    assert!((to_s - 1.7).abs() < 1e-6, "{to_s}");
    harness.get_by_label("eye key at");
    harness.get_by_label("delete").click();
    harness.run();
    assert_eq!(
        harness.state_mut().requests.pop(),
        Some(key(KeyChange::Delete(1)))
    );
    assert!(harness.query_by_label("delete").is_none());
}

#[test]
fn keys_are_added_where_the_time_is() {
    let mut harness = harness();
    harness.state_mut().timeline.seek(25, 0.0);
    harness.run();
    harness.get_by_label("+").click();
    harness.run();
    assert_eq!(
        harness.state_mut().requests.pop(),
        Some(key(KeyChange::Add(2.5)))
    );
    harness.get_by_label("record flight").click();
    harness.run();
    assert_eq!(
        harness.state_mut().requests.pop(),
        Some(ViewRequest::Press(KeyAction::Record))
    );
    // A click on a key selects it, and goes to its frame.
    let last = frame_position(&harness, 40.0);
    for event in [
        Event::PointerMoved(last),
        button(last, true),
        button(last, false),
    ] {
        harness.event(event);
        harness.run();
    }
    assert_eq!(harness.state().timeline.frame(), 40);
    harness.get_by_label("eye key at");
    harness.key_press(Key::Delete);
    harness.run();
    assert_eq!(
        harness.state_mut().requests.pop(),
        Some(key(KeyChange::Delete(2)))
    );
}
