//! Keys of tracks below the timeline: seen, selected, dragged, added and deleted; and the button that records a flight.

use eframe::egui::{self, Color32, Key, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};

use super::panels::ViewRequest;
use crate::viewer::{flight::frame_of, protocol::Task, timeline::Timeline};
use crate::write_back::{KeyChange, KeyEdit, KeyTrack, TrackName, presses::KeyAction};

/// Height of the row of a track, width of its label, and half the width of a key, points.
const ROW: f32 = 18.0;
const LABEL: f32 = 110.0;
const HALF: f32 = 5.0;
/// Rows that are shown at a time.
const ROWS: f32 = 4.0;
/// Step of a drag where times are in seconds.
const STEP_S: f64 = 0.01;

/// State of the keys.
#[derive(Clone, Debug, Default)]
pub struct Keys {
    /// Whether times are in seconds; else in frames.
    pub in_seconds: bool,
    /// The selected key: its track and index.
    selected: Option<(TrackName, usize)>,
    /// Time of the key that is dragged, seconds.
    dragged: Option<(TrackName, usize, f64)>,
    /// Time of the selected key while it is typed, in the unit of the times.
    typed: Option<f64>,
}

/// A time in the unit of the times, rounded to the steps of dragged keys.
fn snapped(timeline: &Timeline, in_seconds: bool, at_s: f64) -> f64 {
    match in_seconds {
        true => (at_s / STEP_S).round() * STEP_S,
        false => f64::from(frame_of(timeline, at_s)) * timeline.frame_s(),
    }
}

/// The rows of keys; `is_recording` tells whether a flight is being recorded.
pub fn panel(
    ui: &mut Ui,
    timeline: &mut Timeline,
    now_s: f64,
    tracks: &[KeyTrack],
    keys: &mut Keys,
    is_recording: bool,
    requests: &mut Vec<ViewRequest>,
) {
    ui.horizontal(|ui| {
        let word = if is_recording {
            "end flight"
        } else {
            "record flight"
        };
        let record = ui.button(word);
        let record = record.on_hover_text("fly while the timeline plays: keys of this camera");
        if record.clicked() {
            requests.push(ViewRequest::Press(KeyAction::Record));
        }
        for (in_seconds, unit) in [(false, "frames"), (true, "seconds")] {
            if ui
                .selectable_label(keys.in_seconds == in_seconds, unit)
                .clicked()
            {
                keys.in_seconds = in_seconds;
            }
        }
        let edit = selected(ui, timeline, tracks, keys);
        requests.extend(edit.map(|edit| Task::Key(edit).into()));
    });
    let area = egui::ScrollArea::vertical().id_salt("keys");
    area.max_height(ROWS * ROW).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for track in tracks {
            let edit = row(ui, timeline, now_s, track, keys);
            requests.extend(edit.map(|edit| Task::Key(edit).into()));
        }
    });
}

/// Controls of the selected key: its time, and its deletion.
fn selected(
    ui: &mut Ui,
    timeline: &Timeline,
    tracks: &[KeyTrack],
    keys: &mut Keys,
) -> Option<KeyEdit> {
    let (name, index) = keys.selected.clone()?;
    let track = tracks.iter().find(|known| known.track == name);
    let Some(at_s) = track.and_then(|track| track.at_s.get(index).copied()) else {
        keys.selected = None;
        return None;
    };
    let edit = |change| {
        let track = name.clone();
        Some(KeyEdit { track, change })
    };
    let unit_s = if keys.in_seconds {
        1.0
    } else {
        timeline.frame_s()
    };
    let label = ui.weak(format!("{} key at", name.key));
    let mut value = keys.typed.unwrap_or(at_s / unit_s);
    let number = egui::DragValue::new(&mut value).max_decimals(3);
    let number = ui.add(number.speed(if keys.in_seconds { STEP_S } else { 0.1 }));
    let number = number.labelled_by(label.id);
    if number.changed() {
        keys.typed = Some(value);
    }
    if let Some(typed) = keys
        .typed
        .filter(|_| number.drag_stopped() || number.lost_focus())
    {
        keys.typed = None;
        return edit(KeyChange::Move(index, typed * unit_s));
    }
    let deletes = ui.button("delete").on_hover_text("Delete").clicked();
    let is_typing = ui.ctx().egui_wants_keyboard_input();
    if deletes || (!is_typing && ui.input(|i| i.key_pressed(Key::Delete))) {
        keys.selected = None;
        return edit(KeyChange::Delete(index));
    }
    None
}

/// Place of the keys of a row, and the time that it shows.
struct Bar {
    rect: Rect,
    start: f64,
    frames: f64,
    frame_s: f64,
}

impl Bar {
    fn in_rect(rect: Rect, timeline: &Timeline) -> Self {
        let [start, end] = [timeline.start(), timeline.end()].map(f64::from);
        Self {
            rect,
            start,
            frames: (end - start).max(1.0),
            frame_s: timeline.frame_s(),
        }
    }

    fn width(&self) -> f64 {
        f64::from(self.rect.width().max(1.0))
    }

    /// Horizontal position of a time, points.
    fn x_of(&self, at_s: f64) -> f32 {
        let share = (at_s / self.frame_s - self.start) / self.frames;
        self.rect.left() + (share * self.width()) as f32
    }

    /// Time of a horizontal position, seconds.
    fn s_of(&self, x: f32) -> f64 {
        let share = f64::from(x - self.rect.left()) / self.width();
        (self.start + share * self.frames) * self.frame_s
    }
}

/// The row of one track.
fn row(
    ui: &mut Ui,
    timeline: &mut Timeline,
    now_s: f64,
    track: &KeyTrack,
    keys: &mut Keys,
) -> Option<KeyEdit> {
    let size = vec2(ui.available_width(), ROW);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let name = &track.track;
    let edit = |change| {
        let track = name.clone();
        KeyEdit { track, change }
    };
    let label = Rect::from_min_size(rect.min, vec2(LABEL, ROW));
    let add = ui.put(
        Rect::from_min_size(label.min, vec2(ROW, ROW)),
        egui::Button::new("+").small(),
    );
    let text = egui::Label::new(format!("{}.{}", name.name, name.key));
    let text_place = Rect::from_min_max(label.min + vec2(ROW + 4.0, 0.0), label.max);
    ui.put(text_place, text.truncate());
    let place = Rect::from_min_max(pos2(label.right() + HALF + 4.0, rect.top()), rect.max);
    let bar = Bar::in_rect(place.with_max_x(place.max.x - HALF), timeline);
    let scope = ui.scope_id().with((name.kind, &name.name, name.key));
    let back = ui.interact(bar.rect, scope, Sense::click());
    let painter = ui.painter().with_clip_rect(rect);
    let line = Stroke::new(1.0, ui.visuals().weak_text_color());
    painter.hline(bar.rect.x_range(), bar.rect.center().y, line);
    let frame_s = bar.frame_s;
    let now = bar.x_of(f64::from(timeline.frame()) * frame_s);
    let line = Stroke::new(1.0, ui.visuals().text_color());
    painter.vline(now, bar.rect.y_range(), line);
    let mut found = None;
    for (index, &at_s) in track.at_s.iter().enumerate() {
        let handle = KeyHandle {
            bar: &bar,
            name,
            index,
            at_s,
        };
        let moved = handle.show(ui, timeline, now_s, keys);
        found = found.or(moved.map(|to_s| edit(KeyChange::Move(index, to_s))));
    }
    if back.double_clicked()
        && let Some(pointer) = back.interact_pointer_pos()
    {
        let at_s = snapped(timeline, keys.in_seconds, bar.s_of(pointer.x));
        found = Some(edit(KeyChange::Add(at_s)));
    }
    if add.on_hover_text("a key at the current frame").clicked() {
        let at_s = f64::from(timeline.frame()) * frame_s;
        found = Some(edit(KeyChange::Add(at_s)));
    }
    found
}

/// A key on the bar of its track.
struct KeyHandle<'a> {
    bar: &'a Bar,
    name: &'a TrackName,
    index: usize,
    at_s: f64,
}

impl KeyHandle<'_> {
    /// Shows the key; returns the time to which a drag has moved it, seconds.
    fn show(&self, ui: &Ui, timeline: &mut Timeline, now_s: f64, keys: &mut Keys) -> Option<f64> {
        let Self {
            bar,
            name,
            index,
            at_s,
        } = *self;
        let is_it = |track: &TrackName, i: usize| track == name && i == index;
        let dragged = keys.dragged.as_ref().filter(|(t, i, _)| is_it(t, *i));
        let x = bar.x_of(dragged.map_or(at_s, |(_, _, to_s)| *to_s));
        if x < bar.rect.left() - HALF || x > bar.rect.right() + HALF {
            return None;
        }
        let center = pos2(x, bar.rect.center().y);
        let rests = pos2(bar.x_of(at_s), center.y);
        let grip = Rect::from_center_size(rests, vec2(2.0 * HALF, ROW));
        let id = ui.scope_id().with((name.kind, &name.name, name.key, index));
        let response = ui.interact(grip, id, Sense::click_and_drag());
        let is_selected = keys.selected.as_ref().is_some_and(|(t, i)| is_it(t, *i));
        let color = match is_selected || response.hovered() {
            true => Color32::from_rgb(255, 150, 30),
            false => ui.visuals().text_color(),
        };
        let corners = [(0.0, -HALF), (HALF, 0.0), (0.0, HALF), (-HALF, 0.0)];
        let corners = corners.map(|(x, y)| center + vec2(x, y)).to_vec();
        let shape = Shape::convex_polygon(corners, color, Stroke::NONE);
        ui.painter().add(shape);
        if response.clicked() || response.drag_started() {
            keys.selected = Some((name.clone(), index));
        }
        if response.clicked() {
            timeline.seek(frame_of(timeline, at_s), now_s);
        }
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let to_s = snapped(timeline, keys.in_seconds, bar.s_of(pointer.x));
            keys.dragged = Some((name.clone(), index, to_s));
        }
        let is_over = response.drag_stopped();
        let frame = at_s / bar.frame_s;
        response.on_hover_text(format!(
            "{} at frame {frame:.1}, {at_s:.3} s; drag moves it, Delete deletes it",
            name.key
        ));
        let (_, _, to_s) = keys.dragged.take_if(|_| is_over)?;
        ((to_s - at_s).abs() > 1e-6).then_some(to_s)
    }
}
