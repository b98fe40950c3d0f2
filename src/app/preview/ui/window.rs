//! The state of the window, and how it asks the rendering thread for something.

use std::{
    collections::{HashMap, VecDeque},
    path::PathBuf,
    time::Instant,
};

use eframe::egui;

use super::{
    camera_controls::CameraControls, diagnostics_panel::Fold, panels::Choice,
    parameter_panel::Parameters, status_message::Note, timeline::Timeline,
};
use crate::{
    app::preview::{
        protocol::{Inspect, Inspection, Judged, Picked, Shown, Task, View},
        render_thread::RenderThread,
        scene_summary::SceneSummary,
    },
    render::stats::FrameStats,
    scene::desc::Method,
};

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
    pub(super) moved_at: f64,
    pub(super) note: Note,
    /// Since when a script runs that the picture does not wait for.
    pub(super) script: Option<Instant>,
    /// Why saves are seen only now and then, and what to do.
    pub(super) unwatched: Option<String>,
    pub(super) is_busy: bool,
    pub(super) viewport: [u32; 2],
    pub(super) shots: PathBuf,
    pub(super) stem: String,
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
}
