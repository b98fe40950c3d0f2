//! One frame of the window: turns keys into requests and a view, and draws only when something
//! changed.

use std::ops::RangeInclusive;

use eframe::egui::{self, Key, Ui};

use super::{
    keys::presses,
    panels::{self, ViewRequest},
    place_panel,
    status_bar::{self, Activity},
    timeline, timeline_keys,
    window::Window,
};
use crate::{
    viewer::{
        protocol::{FrameAction, Screenshot, Task, View, ViewCamera},
        timeline::Timeline,
        view_settings::METHODS,
    },
    write_back::{Numbers, SceneItem},
};

/// Rest time of the camera before the full-resolution picture is rendered, seconds.
const SETTLE_S: f64 = 0.15;
/// Time budget of a picture while the camera moves, milliseconds.
const MOVING_MS: f64 = 50.0;
/// Sidebar width: fraction of the window, limits in points, and the narrowest window with a
/// sidebar, points.
const SIDE_PART: f32 = 0.36;
const SIDE: RangeInclusive<f32> = 250.0..=320.0;
const HAS_SIDE: f32 = 560.0;
/// Delay before a running script is shown, seconds, and the refresh interval from then on.
const LONG_S: f64 = 0.3;
const TOLD_EVERY_S: f32 = 1.0;
/// Fraction of a frame's duration that its picture may take while playing.
const PLAYING_SHARE: f64 = 0.8;

impl Window {
    fn keys(&mut self, ui: &Ui, requests: &mut Vec<ViewRequest>) {
        if ui.ctx().egui_wants_keyboard_input() {
            // F12 is no text input.
            if ui.input(|i| i.key_pressed(Key::F12)) {
                requests.push(ViewRequest::Screenshot);
            }
            return;
        }
        let closes = egui::KeyboardShortcut::new(egui::Modifiers::COMMAND, Key::Q);
        if ui.input_mut(|i| i.consume_shortcut(&closes)) {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
        let pressed = |key| presses(ui, key) > 0;
        if let Some(timeline) = &mut self.timeline {
            timeline::keys(timeline, |key| presses(ui, key), ui.input(|i| i.time));
        }
        let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4];
        for (key, method) in keys.into_iter().zip(METHODS) {
            if pressed(key) {
                self.settings.a.method = method;
            }
        }
        for (key, request) in [
            (Key::F, ViewRequest::Frame),
            (Key::C, ViewRequest::Copy),
            (Key::X, ViewRequest::Compare),
            (Key::F12, ViewRequest::Screenshot),
            (Key::R, self.scene_camera_again()),
        ] {
            if pressed(key) {
                requests.push(request);
            }
        }
        requests.extend(place_panel::keys(ui, &self.selection));
        if pressed(Key::B) {
            self.settings.wipe = !self.settings.wipe;
            self.settings.start_wipe();
        }
        if pressed(Key::G) {
            self.settings.image_frame = !self.settings.image_frame;
        }
        if pressed(Key::H) {
            self.settings.help = !self.settings.help;
        }
        if pressed(Key::Escape) {
            if self.settings.help || self.settings.error_map {
                (self.settings.help, self.settings.error_map) = (false, false);
            } else {
                self.unselect();
            }
        }
    }

    fn handle_requests(&mut self, ui: &Ui, requests: Vec<ViewRequest>) {
        for request in requests {
            match request {
                ViewRequest::SceneCamera(index) => {
                    if let Some((_, camera)) = self.summary.cameras.get(index) {
                        self.camera_controls.camera = camera.clone();
                        (self.settings.scene_camera, self.settings.last_camera) =
                            (Some(index), index);
                        self.settings.follows_cuts = false;
                    }
                }
                ViewRequest::FollowCuts => {
                    self.settings.follows_cuts = true;
                    self.settings.scene_camera = Some(self.settings.last_camera);
                }
                ViewRequest::Frame => self.frame_selection(),
                ViewRequest::Copy => {
                    ui.ctx().copy_text(self.camera_text());
                    (self.message).set("the camera is in the clipboard, as scene text");
                }
                ViewRequest::Compare => self.request_frame(FrameAction::Compare(self.edits)),
                ViewRequest::Screenshot => {
                    self.request_frame(FrameAction::Screenshot(Screenshot {
                        folder: self.screenshot_folder.clone(),
                        stem: self.stem.clone(),
                        wipe_at: self.settings.wipe_at,
                        error_map: self.error_map().is_some(),
                    }));
                }
                ViewRequest::Edit(edit) => {
                    if let Some(row) = self.summary.materials.get_mut(edit.material) {
                        row.edit = *edit;
                    }
                    self.comparison = None;
                    self.edits += 1;
                    self.send(Task::Edit(Box::new(*edit)));
                }
                ViewRequest::SetParameters(overrides) => self.send(Task::SetParameters(overrides)),
                ViewRequest::Select(item) => self.send(Task::Select(item)),
                ViewRequest::Drag(item, numbers) => self.drag(ui, item, numbers),
                ViewRequest::Write(item, numbers) => self.send(Task::Write(item, numbers)),
                ViewRequest::WriteMaterial(material, numbers) => {
                    self.send(Task::WriteMaterial(material, numbers));
                }
                ViewRequest::WriteParameters(values) => self.send(Task::WriteParameters(values)),
                ViewRequest::Key(edit) => self.send(Task::Key(edit)),
                ViewRequest::Record => self.toggle_recording(ui),
                ViewRequest::Undo(again) => self.send(Task::Undo(again)),
            }
        }
    }

    /// Requests the picture of a drag, at the reduced resolution of moving views.
    pub(super) fn drag(&mut self, ui: &Ui, item: SceneItem, numbers: Numbers) {
        self.moved_at = ui.input(|i| i.time);
        self.send(Task::Drag(item, numbers));
    }

    /// Requests the view, if it changed.
    fn request_view(&mut self, ui: &Ui, moved: bool) {
        let now = ui.input(|i| i.time);
        if moved {
            self.moved_at = now;
            self.settings.scene_camera = None;
            self.settings.error_map = false;
        }
        let rests = now - self.moved_at >= SETTLE_S;
        if !rests {
            let wait = SETTLE_S - (now - self.moved_at) + 0.01;
            ui.ctx().request_repaint_after_secs(wait as f32);
        }
        let frame = self.tick(ui, now);
        self.record(frame);
        self.follow_cuts(frame);
        let scene_camera = self
            .settings
            .scene_camera
            .and_then(|i| self.summary.cameras.get(i));
        let view = View {
            camera: match scene_camera {
                Some((name, _)) => ViewCamera::Scene(name.clone()),
                None => ViewCamera::Free(self.camera_controls.camera.clone()),
            },
            chosen: self.chosen_camera(),
            frame,
            plays: self.timeline.as_ref().is_some_and(Timeline::is_playing),
            size: self.picture_size(),
            a: self.settings.a,
            b: self.settings.wipe.then_some(self.settings.b),
            draft_ms: self.draft_ms(rests),
        };
        if self
            .requested
            .as_ref()
            .is_some_and(|requested| requested.frame != frame)
        {
            self.settings.error_map = false;
        }
        // A minimized window has no pixels.
        if view.size.iter().all(|side| *side > 0) && self.requested.as_ref() != Some(&view) {
            self.is_busy = true;
            self.render_thread.mailbox.post_view(view.clone());
            self.requested = Some(view);
        }
    }

    /// Request for the scene's camera that was shown last.
    fn scene_camera_again(&self) -> ViewRequest {
        match self.settings.follows_cuts && !self.summary.cuts.is_empty() {
            true => ViewRequest::FollowCuts,
            false => ViewRequest::SceneCamera(self.settings.last_camera),
        }
    }

    /// Name of the scene's camera that was chosen last; `None` while the cuts choose.
    fn chosen_camera(&self) -> Option<String> {
        let cameras = &self.summary.cameras;
        let chosen = cameras.get(self.settings.last_camera);
        let chosen = chosen.filter(|_| !self.settings.follows_cuts);
        chosen.map(|(name, _)| name.clone())
    }

    /// Shows the camera of the cuts, unless another one was chosen or moved.
    fn follow_cuts(&mut self, frame: u32) {
        let settings = &mut self.settings;
        let is_free = !settings.follows_cuts || settings.scene_camera.is_none();
        if let Some(index) = self.summary.cut_at(frame).filter(|_| !is_free) {
            (settings.scene_camera, settings.last_camera) = (Some(index), index);
        }
    }

    /// The timeline's frame now; schedules a repaint for the next one.
    fn tick(&mut self, ui: &Ui, now_s: f64) -> u32 {
        let Some(timeline) = &mut self.timeline else {
            return 0;
        };
        if let Some(wait_s) = timeline.tick(now_s) {
            ui.ctx().request_repaint_after_secs(wait_s as f32);
        }
        timeline.frame()
    }

    /// Time budget of a picture while something moves.
    fn draft_ms(&self, rests: bool) -> Option<f64> {
        let moving = (!rests).then_some(MOVING_MS);
        let playing = self.timeline.as_ref().filter(|time| time.is_playing());
        let playing = playing.map(|time| time.frame_s() * 1e3 * PLAYING_SHARE);
        moving.into_iter().chain(playing).reduce(f64::min)
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
        let doing = if self.timeline.as_ref().is_some_and(Timeline::is_playing) {
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
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let now_s = ui.input(|i| i.time);
        self.message.expire_on_input(ui, now_s);
        self.handle_reports(now_s);
        let mut requests = Vec::new();
        self.keys(ui, &mut requests);
        egui::Panel::top("bar").show(ui, |ui| {
            ui.add_space(3.0);
            panels::bar(ui, &mut self.settings, &self.summary, &mut requests);
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
        let is_recording = self.recording.is_some();
        if let Some(timeline) = &mut self.timeline {
            egui::Panel::bottom("timeline").show(ui, |ui| {
                ui.add_space(2.0);
                let shown = self.shown.as_ref().map(|shown| shown.frame);
                let is_stuck = !self.summary.problems.pose.is_empty() || is_slow;
                timeline::panel(ui, timeline, shown, is_stuck, now_s);
                let keys = &mut self.keys;
                timeline_keys::panel(
                    ui,
                    (timeline, now_s),
                    &tracks,
                    (keys, is_recording),
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
        let mut is_open = self.settings.help;
        status_bar::help(ui, &mut is_open);
        self.settings.help &= is_open;
        self.handle_requests(ui, requests);
        self.request_view(ui, central.inner);
        self.message.tick(ui, now_s);
    }
}
