//! State of the window and its requests to the rendering thread.

use std::{
    collections::{HashMap, VecDeque},
    path::PathBuf,
    time::Instant,
};

use eframe::egui;

use super::{
    diagnostics_panel::FoldState, flight::Flight, parameter_panel::Parameters,
    place_panel::Selection, status_message::StatusMessage, timeline_keys::Keys,
};
use crate::viewer::{
    camera_controls::CameraControls,
    protocol::{
        Comparison, FinishedFrame, FrameAction, FrameRequest, Picked, PixelValue, Task, View,
    },
    render_thread::RenderThread,
    scene_summary::SceneSummary,
    timeline::Timeline,
    view_settings::ViewSettings,
};
use reflet_render::stats::FrameStats;
use reflet_scene::desc::Method;

/// The application.
pub struct Window {
    pub(super) render_thread: RenderThread,
    pub(super) summary: SceneSummary,
    pub(super) settings: ViewSettings,
    pub(super) camera_controls: CameraControls,
    /// Timeline, if the scene has one.
    pub(super) timeline: Option<Timeline>,
    /// Timeline of the last scene that had one.
    pub(super) hidden_timeline: Option<Timeline>,
    /// Keys of tracks on the timeline.
    pub(super) keys: Keys,
    /// Flight that is being recorded.
    pub(super) recording: Option<Flight>,
    pub(super) parameters: Parameters,
    /// Whether the diagnostics panel is folded.
    pub(super) fold: FoldState,
    pub(super) shown: Option<FinishedFrame>,
    pub(super) comparison: Option<Comparison>,
    /// The selected instance.
    pub(super) picked: Option<Picked>,
    /// The selected item of the scene text.
    pub(super) selection: Selection,
    /// Values of the clicked pixel.
    pub(super) pixel: Vec<PixelValue>,
    /// Revision of the scene; comparisons of earlier revisions are stale.
    pub(super) edits: u64,
    /// Statistics of the last pictures, newest last.
    pub(super) history: VecDeque<FrameStats>,
    /// Registered egui textures by the number of their `FrameTexture`.
    pub(super) textures: HashMap<u64, egui::TextureId>,
    /// The view that was requested last.
    pub(super) requested: Option<View>,
    /// Time of the last camera move, seconds.
    pub(super) moved_at: f64,
    pub(super) message: StatusMessage,
    /// Start of a script that runs in the background.
    pub(super) script: Option<Instant>,
    /// Why file watching is limited, and what to do.
    pub(super) unwatched: Option<String>,
    pub(super) is_busy: bool,
    pub(super) viewport: [u32; 2],
    pub(super) screenshot_folder: PathBuf,
    pub(super) stem: String,
}

impl Window {
    /// Whether the cuts of the timeline choose the camera, until another one is chosen.
    pub fn set_follows_cuts(&mut self, follows: bool) {
        self.settings.follows_cuts = follows;
    }

    /// A window that first shows `method` through the scene's camera of this index, and writes
    /// screenshots into this folder with this file name prefix.
    pub fn new(
        render_thread: RenderThread,
        summary: SceneSummary,
        method: Method,
        camera: usize,
        (screenshot_folder, stem): (PathBuf, String),
    ) -> Self {
        let mut settings = ViewSettings::new(method);
        (settings.scene_camera, settings.last_camera) = (Some(camera), camera);
        let start = summary.cameras.get(camera);
        let start = start.map(|(_, camera)| camera.clone()).unwrap_or_default();
        Self {
            camera_controls: CameraControls::new(start, &summary.bounds),
            timeline: summary.timeline.as_ref().map(Timeline::new),
            hidden_timeline: None,
            keys: Keys::default(),
            recording: None,
            parameters: Parameters::default(),
            fold: FoldState::default(),
            render_thread,
            summary,
            settings,
            shown: None,
            comparison: None,
            picked: None,
            selection: Selection::default(),
            pixel: Vec::new(),
            edits: 0,
            history: VecDeque::new(),
            textures: HashMap::new(),
            requested: None,
            moved_at: f64::NEG_INFINITY,
            message: StatusMessage::default(),
            script: None,
            unwatched: None,
            is_busy: false,
            viewport: [0, 0],
            screenshot_folder,
            stem,
        }
    }

    pub(super) fn send(&mut self, task: Task) {
        self.is_busy = true;
        self.render_thread.mailbox.post(task);
    }

    /// Requests an action on the view's frame; while playing, on the displayed one.
    pub(super) fn request_frame(&mut self, action: FrameAction) {
        let Some(mut view) = self.requested.clone() else {
            self.message.set("nothing is shown yet");
            return;
        };
        if let (true, Some(shown)) = (view.plays, &self.shown) {
            view.frame = shown.frame;
        }
        self.send(Task::Frame(FrameRequest { view, action }));
    }
}
