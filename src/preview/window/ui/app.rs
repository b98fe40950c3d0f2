//! One frame of the window: turns keys into requests and a view, and draws only when something
//! changed.

use std::ops::RangeInclusive;

use eframe::egui::{self, Ui};

use super::{
    keys::presses,
    panels::{self, ViewRequest},
    status_bar::{self, Activity},
    timeline, timeline_keys,
    window::Window,
};
use crate::{
    viewer::{
        protocol::{FrameAction, Screenshot, ScreenshotGoal, Task},
        recording::RECORDING,
        timeline::Timeline,
    },
    write_back::{
        KeyTrack,
        presses::{self, KeyAction},
    },
};

/// Sidebar width: fraction of the window, limits in points, and the narrowest window with a
/// sidebar, points.
const SIDE_PART: f32 = 0.36;
const SIDE: RangeInclusive<f32> = 250.0..=320.0;
const HAS_SIDE: f32 = 560.0;
/// Delay before a running script is shown, seconds, and the refresh interval from then on.
const LONG_S: f64 = 0.3;
const TOLD_EVERY_S: f32 = 1.0;

impl Window {
    fn keys(&mut self, ui: &Ui) {
        let is_typing = ui.ctx().egui_wants_keyboard_input();
        for press in presses::presses() {
            // F12 is no text input.
            if !is_typing || press.action == KeyAction::Screenshot {
                (0..presses(ui, press)).for_each(|_| self.press(ui, press.action));
            }
        }
    }

    /// Does what a key or a button does.
    fn press(&mut self, ui: &Ui, action: KeyAction) {
        if self.state.press(action, ui.input(|i| i.time)) {
            return;
        }
        match action {
            KeyAction::Frame => self.frame_selection(),
            KeyAction::Copy => {
                ui.ctx().copy_text(self.camera_text());
                (self.message).set("the camera is in the clipboard, as scene text");
            }
            KeyAction::Compare => self.request_frame(FrameAction::Compare(self.edits)),
            KeyAction::Screenshot => self.request_frame(FrameAction::Screenshot(Screenshot {
                goal: ScreenshotGoal::File {
                    folder: self.screenshot_folder.clone(),
                    stem: self.stem.clone(),
                },
                wipe_at: self.state.settings.wipe_at,
                error_map: self.error_map().is_some(),
            })),
            KeyAction::Unpick if self.state.settings.help || self.state.settings.error_map => {
                (self.state.settings.help, self.state.settings.error_map) = (false, false);
            }
            KeyAction::Unpick => self.unselect(),
            KeyAction::Nudge(by) => {
                let moved = self.selection.moved(by);
                let written = moved.map(|(item, numbers)| Task::Write(item, numbers));
                written.into_iter().for_each(|task| self.send(task));
            }
            KeyAction::Undo(again) => self.send(Task::Undo(again)),
            KeyAction::Record => self.toggle_recording(ui),
            KeyAction::Close => ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close),
            _ => {}
        }
    }

    fn handle_requests(&mut self, ui: &Ui, requests: Vec<ViewRequest>) {
        for request in requests {
            match request {
                ViewRequest::SceneCamera(index) => self.state.choose_camera(index),
                ViewRequest::FollowCuts => self.state.follow_cuts(),
                ViewRequest::Press(action) => self.press(ui, action),
                ViewRequest::Task(task) => self.request_task(ui, task),
            }
        }
    }

    /// Sends a task, and notes what the window shows of it before it is done.
    pub(super) fn request_task(&mut self, ui: &Ui, task: Task) {
        match &task {
            Task::Edit(edit) => {
                if let Some(row) = self.state.summary.materials.get_mut(edit.material) {
                    row.edit = **edit;
                }
                self.comparison = None;
                self.edits += 1;
            }
            // Pictures of a drag have the reduced resolution of moving views.
            Task::Drag(..) => self.state.stir(ui.input(|i| i.time)),
            _ => {}
        }
        self.send(task);
    }

    /// Requests the view, if it changed.
    fn request_view(&mut self, ui: &Ui, moved: bool) {
        let now_s = ui.input(|i| i.time);
        if moved {
            self.state.move_camera(now_s);
        }
        if let Some(wait_s) = self.state.advance(now_s) {
            ui.ctx().request_repaint_after_secs(wait_s as f32);
        }
        self.record();
        let view = self.state.view(self.picture_size(), now_s);
        let before = self.state.requested.as_ref();
        if before.is_some_and(|before| before.frame != view.frame) {
            self.state.settings.error_map = false;
        }
        // A minimized window has no pixels.
        if view.size.iter().all(|side| *side > 0) && self.state.request(&view) {
            self.is_busy = true;
            self.render_thread.mailbox.post_view(view);
        }
    }

    /// Text about reduced resolution; empty at full resolution.
    fn reduced(&self) -> String {
        let sides = self.shown.as_ref().and_then(|shown| shown.sides.first());
        match sides.map(|side| side.stats.size) {
            Some([width, height]) if [width, height] != self.picture_size() => {
                format!(", rendered at {width}x{height} to hold the frame rate")
            }
            _ => String::new(),
        }
    }

    fn status(&mut self, ui: &mut Ui) {
        let picture = self.shown.as_ref().map_or(0, |shown| shown.number);
        let doing = if self
            .state
            .timeline
            .as_ref()
            .is_some_and(Timeline::is_playing)
        {
            Activity::Playing(self.reduced())
        } else if self.is_busy {
            Activity::Drawing
        } else {
            Activity::Idle
        };
        let script_s = self.script_s();
        status_bar::status(ui, picture, &doing, script_s, &mut self.message);
    }

    /// Run time of a background script once it exceeds `LONG_S`, seconds.
    fn script_s(&self) -> Option<f64> {
        let ran_s = self.script.map(|since| since.elapsed().as_secs_f64());
        ran_s.filter(|ran_s| *ran_s >= LONG_S)
    }

    /// Starts to record a flight, or ends it.
    fn toggle_recording(&mut self, ui: &Ui) {
        let ended = self.state.toggle_recording(ui.input(|i| i.time));
        ended.into_iter().for_each(|task| self.send(task));
        if self.state.recording.is_some() {
            self.message.set(RECORDING);
        }
    }

    /// Records the camera at the current frame.
    fn record(&mut self) {
        let ended = self.state.record();
        ended.into_iter().for_each(|task| self.send(task));
    }

    /// Tracks with keys of the selected item, else of the camera that was shown last.
    fn tracks_of_selection(&self) -> Vec<KeyTrack> {
        let tracks = self.state.tracks_of(self.selection.shown());
        tracks.into_iter().cloned().collect()
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let now_s = ui.input(|i| i.time);
        self.message.expire_on_input(ui, now_s);
        self.handle_reports(now_s);
        let mut requests = Vec::new();
        self.keys(ui);
        egui::Panel::top("bar").show(ui, |ui| {
            ui.add_space(3.0);
            panels::bar(
                ui,
                &mut self.state.settings,
                &self.state.summary,
                &mut requests,
            );
            ui.add_space(2.0);
        });
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        if let Some(why) = &self.unwatched {
            egui::Panel::bottom("unwatched").show(ui, |ui| status_bar::unwatched(ui, why));
        }
        if self.script.is_some() {
            ui.ctx().request_repaint_after_secs(TOLD_EVERY_S);
        }
        let is_slow = self.script_s().is_some();
        let tracks = self.tracks_of_selection();
        let is_recording = self.state.recording.is_some();
        if let Some(timeline) = &mut self.state.timeline {
            egui::Panel::bottom("timeline").show(ui, |ui| {
                ui.add_space(2.0);
                let shown = self.shown.as_ref().map(|shown| shown.frame);
                let is_stuck = !self.state.summary.problems.pose.is_empty() || is_slow;
                timeline::panel(ui, timeline, shown, is_stuck, now_s);
                let keys = &mut self.keys;
                timeline_keys::panel(
                    ui,
                    timeline,
                    now_s,
                    &tracks,
                    keys,
                    is_recording,
                    &mut requests,
                );
                ui.add_space(1.0);
            });
        }
        let width = ui.available_width();
        if width >= HAS_SIDE {
            let side = (width * SIDE_PART).clamp(*SIDE.start(), *SIDE.end());
            egui::Panel::right("side")
                .resizable(false)
                .exact_size(side)
                .show(ui, |ui| self.side_panel(ui, &mut requests));
        }
        let central = egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, frame));
        let mut is_open = self.state.settings.help;
        status_bar::help(ui, &mut is_open);
        self.state.settings.help &= is_open;
        self.handle_requests(ui, requests);
        self.request_view(ui, central.inner);
        self.message.tick(ui, now_s);
    }
}
