//! The window: turns pointer and keys into a view, shows what comes back, and draws only when
//! something changed.

use std::{
    collections::{HashMap, VecDeque},
    ops::RangeInclusive,
    path::PathBuf,
    time::Instant,
};

use eframe::egui::{self, Key, Ui};

use crate::{render::stats::FrameStats, scene::desc::Method};

use super::{
    camera_controls::CameraControls,
    diagnostics_panel::Fold,
    panels::{self, Choice, METHODS, ViewRequest},
    parameter_panel::Parameters,
    picking::Picked,
    protocol::{
        Inspect, Inspection, Judged, SceneSummary, Screenshot, Shown, Task, View, ViewCamera,
    },
    render_thread::RenderThread,
    status_bar::{self, Doing},
    status_message::Note,
    timeline::{self, Timeline},
};

/// How long the camera must rest before the full picture is drawn, seconds.
const SETTLE_S: f64 = 0.15;
/// Longest that a picture should take while the camera moves, milliseconds.
const MOVING_MS: f64 = 50.0;
/// Width of the panel beside the picture, points: this part of the window, in this range; and of the
/// narrowest window that has one.
const SIDE_PART: f32 = 0.36;
const SIDE: RangeInclusive<f32> = 250.0..=320.0;
const HAS_SIDE: f32 = 560.0;
/// How long a script runs before that is told, seconds, and how often from then on.
const LONG_S: f64 = 0.3;
const TOLD_EVERY_S: f32 = 1.0;
/// Part of a frame's time that its picture may take while time runs.
const PLAYING_SHARE: f64 = 0.8;

/// The application.
pub struct Window {
    pub(super) worker: RenderThread,
    pub(super) facts: SceneSummary,
    pub(super) choice: Choice,
    pub(super) navigator: CameraControls,
    /// Where time is, if the scene has frames.
    pub(super) timeline: Option<Timeline>,
    /// Where time was when the scene last had some.
    pub(super) put_away: Option<Timeline>,
    pub(super) parameters: Parameters,
    /// Whether the list of mistakes is folded.
    pub(super) fold: Fold,
    pub(super) shown: Option<Shown>,
    pub(super) judged: Option<Judged>,
    /// The selected instance.
    pub(super) picked: Option<Picked>,
    /// How often the scene has changed: what was compared before is of another.
    pub(super) edits: u64,
    /// Of the last pictures, newest last.
    pub(super) history: VecDeque<FrameStats>,
    /// Registered textures by the number of their canvas.
    pub(super) textures: HashMap<u64, egui::TextureId>,
    /// The view that was last asked for.
    pub(super) asked: Option<View>,
    /// When the camera moved last, seconds.
    moved_at: f64,
    pub(super) note: Note,
    /// Since when a script runs that the picture does not wait for.
    pub(super) script: Option<Instant>,
    /// Why saves are seen only now and then, and what to do.
    pub(super) unwatched: Option<String>,
    pub(super) is_busy: bool,
    pub(super) viewport: [u32; 2],
    shots: PathBuf,
    stem: String,
}

impl Window {
    /// A window over a scene that shows `method` through the scene's camera of this index at first,
    /// and writes pictures of this stem into this folder.
    pub fn new(
        worker: RenderThread,
        facts: SceneSummary,
        method: Method,
        camera: usize,
        (shots, stem): (PathBuf, String),
    ) -> Self {
        let mut choice = Choice::new(method);
        (choice.through, choice.home) = (Some(camera), camera);
        let start = facts.cameras.get(camera);
        let start = start.map(|(_, camera)| camera.clone()).unwrap_or_default();
        Self {
            navigator: CameraControls::new(start, &facts.bounds),
            timeline: facts.timeline.as_ref().map(Timeline::new),
            put_away: None,
            parameters: Parameters::default(),
            fold: Fold::default(),
            worker,
            facts,
            choice,
            shown: None,
            judged: None,
            picked: None,
            edits: 0,
            history: VecDeque::new(),
            textures: HashMap::new(),
            asked: None,
            moved_at: f64::NEG_INFINITY,
            note: Note::default(),
            script: None,
            unwatched: None,
            is_busy: false,
            viewport: [0, 0],
            shots,
            stem,
        }
    }

    pub(super) fn ask(&mut self, task: Task) {
        self.is_busy = true;
        self.worker.mailbox.ask(task);
    }

    fn keys(&mut self, ui: &Ui, overrides: &mut Vec<ViewRequest>) {
        if ui.ctx().egui_wants_keyboard_input() {
            // It writes no text.
            if ui.input(|i| i.key_pressed(Key::F12)) {
                overrides.push(ViewRequest::Screenshot);
            }
            return;
        }
        let closes = egui::KeyboardShortcut::new(egui::Modifiers::COMMAND, Key::Q);
        if ui.input_mut(|i| i.consume_shortcut(&closes)) {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
        let pressed = |key| ui.input(|i| i.key_pressed(key) && i.modifiers.is_none());
        if let Some(timeline) = &mut self.timeline {
            let presses = |key| {
                ui.input(|i| {
                    if i.modifiers.is_none() {
                        i.num_presses(key)
                    } else {
                        0
                    }
                })
            };
            timeline::keys(timeline, presses, ui.input(|i| i.time));
        }
        for (key, (method, _)) in [Key::Num1, Key::Num2, Key::Num3].into_iter().zip(METHODS) {
            if pressed(key) {
                self.choice.a.method = method;
            }
        }
        for (key, set_overrides) in [
            (Key::F, ViewRequest::Frame),
            (Key::C, ViewRequest::Copy),
            (Key::X, ViewRequest::Judge),
            (Key::F12, ViewRequest::Screenshot),
            (Key::R, ViewRequest::Through(self.choice.home)),
        ] {
            if pressed(key) {
                overrides.push(set_overrides);
            }
        }
        if pressed(Key::B) {
            self.choice.wipe = !self.choice.wipe;
        }
        if pressed(Key::H) {
            self.choice.help = !self.choice.help;
        }
        if pressed(Key::Escape) {
            if self.choice.help || self.choice.heat {
                (self.choice.help, self.choice.heat) = (false, false);
            } else {
                self.unselect();
            }
        }
    }

    fn grant(&mut self, ui: &Ui, overrides: Vec<ViewRequest>) {
        for set_overrides in overrides {
            match set_overrides {
                ViewRequest::Through(index) => {
                    if let Some((_, camera)) = self.facts.cameras.get(index) {
                        self.navigator.camera = camera.clone();
                        (self.choice.through, self.choice.home) = (Some(index), index);
                    }
                }
                ViewRequest::Frame => self.frame_selection(),
                ViewRequest::Copy => {
                    ui.ctx().copy_text(self.camera_text());
                    (self.note).say("the camera is in the clipboard, as scene text");
                }
                ViewRequest::Judge => self.inspect(Inspect::Judge(self.edits)),
                ViewRequest::Screenshot => {
                    self.inspect(Inspect::Screenshot(Screenshot {
                        folder: self.shots.clone(),
                        stem: self.stem.clone(),
                        wipe_at: self.choice.wipe_at,
                        heat: self.heat().is_some(),
                    }));
                }
                ViewRequest::Edit(edit) => {
                    if let Some(row) = self.facts.materials.get_mut(edit.material) {
                        row.edit = edit;
                    }
                    self.judged = None;
                    self.edits += 1;
                    self.ask(Task::Edit(edit));
                }
                ViewRequest::Tune(tuned) => self.ask(Task::Tune(tuned)),
            }
        }
    }

    /// Asks for something of the view's frame; while time runs, of the one that is seen.
    pub(super) fn inspect(&mut self, with: Inspect) {
        let Some(mut view) = self.asked.clone() else {
            self.note.say("nothing is shown yet");
            return;
        };
        if let (true, Some(shown)) = (view.plays, &self.shown) {
            view.frame = shown.frame;
        }
        self.ask(Task::Inspect(Inspection { view, with }));
    }

    /// Asks for the view, if it is another than before.
    fn ask_view(&mut self, ui: &Ui, moved: bool) {
        let now = ui.input(|i| i.time);
        if moved {
            self.moved_at = now;
            self.choice.through = None;
            self.choice.heat = false;
        }
        let rests = now - self.moved_at >= SETTLE_S;
        if !rests {
            let wait = SETTLE_S - (now - self.moved_at) + 0.01;
            ui.ctx().request_repaint_after_secs(wait as f32);
        }
        let frame = self.tick(ui, now);
        let through = self.choice.through.and_then(|i| self.facts.cameras.get(i));
        let view = View {
            eye: match through {
                Some((name, _)) => ViewCamera::Through(name.clone()),
                None => ViewCamera::Free(self.navigator.camera.clone()),
            },
            frame,
            plays: self.timeline.as_ref().is_some_and(Timeline::is_playing),
            size: self.viewport,
            a: self.choice.a,
            b: self.choice.wipe.then_some(self.choice.b),
            draft_ms: self.draft_ms(rests),
        };
        if self
            .asked
            .as_ref()
            .is_some_and(|asked| asked.frame != frame)
        {
            self.choice.heat = false;
        }
        // A minimized window has no pixels: nothing is asked for.
        if view.size.iter().all(|side| *side > 0) && self.asked.as_ref() != Some(&view) {
            self.is_busy = true;
            self.worker.mailbox.show(view.clone());
            self.asked = Some(view);
        }
    }

    /// The frame that the clock wants now; the next one is waited for.
    fn tick(&mut self, ui: &Ui, now_s: f64) -> u32 {
        let Some(timeline) = &mut self.timeline else {
            return 0;
        };
        if let Some(wait_s) = timeline.tick(now_s) {
            ui.ctx().request_repaint_after_secs(wait_s as f32);
        }
        timeline.frame()
    }

    /// How long a picture may take while something moves.
    fn draft_ms(&self, rests: bool) -> Option<f64> {
        let moving = (!rests).then_some(MOVING_MS);
        let playing = self.timeline.as_ref().filter(|time| time.is_playing());
        let playing = playing.map(|time| time.frame_s() * 1e3 * PLAYING_SHARE);
        moving.into_iter().chain(playing).reduce(f64::min)
    }

    /// How much smaller the shown picture was drawn than its place is, in words.
    fn reduced(&self) -> String {
        let sides = self.shown.as_ref().and_then(|shown| shown.sides.first());
        match sides.map(|side| side.stats.size) {
            Some([width, height]) if width < self.viewport[0] || height < self.viewport[1] => {
                format!(", drawn at {width}x{height} to keep up")
            }
            _ => String::new(),
        }
    }

    fn status(&mut self, ui: &mut Ui) {
        let picture = self.shown.as_ref().map_or(0, |shown| shown.number);
        let doing = if self.timeline.as_ref().is_some_and(Timeline::is_playing) {
            Doing::Plays(self.reduced())
        } else if self.is_busy {
            Doing::Draws
        } else {
            Doing::Rests
        };
        let script_s = self.script_s();
        status_bar::status(ui, picture, &doing, script_s, &mut self.note);
    }

    /// How long a script has been running, once that is worth telling, seconds.
    fn script_s(&self) -> Option<f64> {
        let ran_s = self.script.map(|since| since.elapsed().as_secs_f64());
        ran_s.filter(|ran_s| *ran_s >= LONG_S)
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let now_s = ui.input(|i| i.time);
        self.note.give_way(ui, now_s);
        self.receive(now_s);
        let mut overrides = Vec::new();
        self.keys(ui, &mut overrides);
        egui::Panel::top("bar").show(ui, |ui| {
            ui.add_space(3.0);
            panels::bar(ui, &mut self.choice, &self.facts, &mut overrides);
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
        if let Some(timeline) = &mut self.timeline {
            egui::Panel::bottom("timeline").show(ui, |ui| {
                ui.add_space(2.0);
                let shown = self.shown.as_ref().map(|shown| shown.frame);
                let is_stuck = !self.facts.problems.pose.is_empty() || is_slow;
                timeline::panel(ui, timeline, shown, is_stuck, now_s);
                ui.add_space(1.0);
            });
        }
        let width = ui.available_width();
        if width >= HAS_SIDE {
            let side = (width * SIDE_PART).clamp(*SIDE.start(), *SIDE.end());
            egui::Panel::right("side")
                .resizable(false)
                .exact_size(side)
                .show(ui, |ui| self.side_panel(ui, &mut overrides));
        }
        let central = egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, frame));
        let mut is_open = self.choice.help;
        status_bar::help(ui, &mut is_open);
        self.choice.help &= is_open;
        self.grant(ui, overrides);
        self.ask_view(ui, central.inner);
        self.note.tick(ui, now_s);
    }
}
