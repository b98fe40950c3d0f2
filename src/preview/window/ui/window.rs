//! State of the window and its requests to the rendering thread.

use std::{
    collections::{HashMap, VecDeque},
    path::PathBuf,
    time::Instant,
};

use eframe::egui;

use super::{
    diagnostics_panel::FoldState, parameter_panel::Parameters, place_panel::OutlineScroll,
    status_message::StatusMessage, timeline_keys::Keys,
};
use crate::{
    viewer::{
        protocol::{
            Comparison, FinishedFrame, FrameAction, FrameRequest, Picked, PixelValue, Task,
        },
        render_thread::RenderThread,
        view_state::ViewState,
    },
    write_back::selection::Selection,
};
use reflet_render::renderer::stats::FrameStats;

/// The application.
pub struct Window {
    pub(super) render_thread: RenderThread,
    pub(super) state: ViewState,
    /// Keys of tracks on the timeline.
    pub(super) keys: Keys,
    pub(super) parameters: Parameters,
    /// Whether the diagnostics panel is folded.
    pub(super) fold: FoldState,
    pub(super) shown: Option<FinishedFrame>,
    pub(super) comparison: Option<Comparison>,
    /// The selected instance.
    pub(super) picked: Option<Picked>,
    /// The selected item of the scene text.
    pub(super) selection: Selection,
    pub(super) outline: OutlineScroll,
    /// Values of the clicked pixel.
    pub(super) pixel: Vec<PixelValue>,
    /// Revision of the scene; comparisons of earlier revisions are stale.
    pub(super) edits: u64,
    /// Statistics of the last pictures, newest last.
    pub(super) history: VecDeque<FrameStats>,
    /// Registered egui textures by the number of their `FrameTexture`.
    pub(super) textures: HashMap<u64, egui::TextureId>,
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
    /// A window that shows a state, and writes screenshots into this folder with this file name prefix.
    pub fn new(
        render_thread: RenderThread,
        state: ViewState,
        screenshot_folder: PathBuf,
        stem: String,
    ) -> Self {
        Self {
            state,
            keys: Keys::default(),
            parameters: Parameters::default(),
            fold: FoldState::default(),
            render_thread,
            shown: None,
            comparison: None,
            picked: None,
            selection: Selection::default(),
            outline: OutlineScroll::default(),
            pixel: Vec::new(),
            edits: 0,
            history: VecDeque::new(),
            textures: HashMap::new(),
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
        let Some(mut view) = self.state.requested.clone() else {
            self.message.set("nothing is shown yet");
            return;
        };
        if let (true, Some(shown)) = (view.plays, &self.shown) {
            view.frame = shown.frame;
        }
        self.send(Task::Frame(Box::new(FrameRequest { view, action })));
    }
}
