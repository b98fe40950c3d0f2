//! Opens scenes: the first one, and those that are dropped on the window or chosen in it.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        mpsc::{self, Receiver, TryRecvError},
    },
    thread,
};

use eframe::egui;

use super::window::Window;
use crate::{
    live::{Live, SceneSource, ViewOverrides},
    viewer::{
        opening::open, picture_filter::PictureFilter, render_thread::RenderThread,
        scene_summary::SceneSummary, view_state::ViewState,
    },
    window::WindowOptions,
};
use reflet_gpu::Gpu;
use reflet_render::runtime::SessionError;
use reflet_scene::{desc::Method, diagnostic::print_diagnostics};

/// Device and settings with which scenes are opened.
#[derive(Clone)]
pub struct Opener {
    gpu: Arc<Gpu>,
    source: SceneSource,
    overrides: ViewOverrides,
    method: Option<Method>,
    screenshots: PathBuf,
    denoiser: Option<PictureFilter>,
}

/// A loaded scene with its renderer, and the initial state of its window.
pub struct Opened {
    live: Live,
    /// Whether the scene must be reloaded at once.
    is_waiting: bool,
    summary: SceneSummary,
    method: Method,
    camera: usize,
    follows_cuts: bool,
    stem: String,
}

impl Opener {
    /// Opener for the options of a window.
    pub fn new(gpu: Arc<Gpu>, options: &WindowOptions) -> Self {
        Self {
            gpu,
            source: options.source.clone(),
            overrides: ViewOverrides {
                size: Some([64, 64]),
                method: options.method,
                costs: options.costs,
                guides: options.denoiser.is_some(),
                ..ViewOverrides::default()
            },
            method: options.method,
            screenshots: options.screenshots.clone(),
            denoiser: options.denoiser.clone(),
        }
    }

    /// Opens the first scene, shown by the camera of this name.
    ///
    /// # Errors
    /// Same errors as [`open`], and a camera that the scene does not have.
    pub fn first(&self, camera: Option<&str>) -> Result<Opened, SessionError> {
        self.open(self.source.clone(), camera)
    }

    /// Opens another scene or model, without the `--set` and `--variant` of the first one.
    ///
    /// # Errors
    /// Same errors as [`open`].
    pub fn another(&self, path: &Path) -> Result<Opened, SessionError> {
        let mut source = self.source.clone();
        source.path = Some(path.to_owned());
        (source.options.set, source.options.variant) = (Vec::new(), Vec::new());
        self.open(source, None)
    }

    fn open(&self, source: SceneSource, camera: Option<&str>) -> Result<Opened, SessionError> {
        let stem = source.path.as_deref().and_then(Path::file_stem);
        let stem = stem.map_or("atrium".into(), |stem| stem.to_string_lossy().into_owned());
        let opened = open(&self.gpu, source, self.overrides.clone(), camera.is_none());
        let (live, is_waiting) = opened?;
        print_diagnostics(live.warnings());
        let summary = SceneSummary::of(&live);
        Ok(Opened {
            camera: live.camera(camera)?,
            live,
            is_waiting,
            method: self.method.unwrap_or(summary.method),
            follows_cuts: camera.is_none(),
            summary,
            stem,
        })
    }

    /// Title of the window.
    pub fn title(&self, opened: &Opened) -> String {
        format!("{} – Reflet on {}", opened.stem, self.gpu.adapter_info.name)
    }

    /// Starts rendering, and repaints the window of the context with each report.
    pub fn start(&self, opened: Opened, context: &egui::Context) -> Window {
        let repaint = context.clone();
        let repaint = move || repaint.request_repaint();
        let (live, is_waiting) = (opened.live, opened.is_waiting);
        let thread = RenderThread::start(
            self.gpu.clone(),
            live,
            is_waiting,
            self.denoiser.clone(),
            repaint,
        );
        let place = (self.screenshots.clone(), opened.stem);
        let state = ViewState::new(
            opened.summary,
            opened.method,
            opened.camera,
            opened.follows_cuts,
        );
        Window::new(thread, state, place)
    }
}

/// A scene that is being opened beside the one that is shown.
pub struct Opening {
    /// Path of the scene.
    pub path: PathBuf,
    outcome: Receiver<Result<Opened, String>>,
}

impl Opening {
    /// Starts opening a scene on another thread; the window of the context is repainted at the end.
    pub fn begin(opener: &Opener, path: PathBuf, context: &egui::Context) -> Self {
        let (sender, outcome) = mpsc::channel();
        let (opener, context, file) = (opener.clone(), context.clone(), path.clone());
        thread::spawn(move || {
            let opened = opener.another(&file).map_err(|error| error.to_string());
            // The window may be closed meanwhile.
            let _ = sender.send(opened);
            context.request_repaint();
        });
        Self { path, outcome }
    }

    /// The opened scene, or an error message; `None` while it is being opened.
    pub fn outcome(&self) -> Option<Result<Opened, String>> {
        match self.outcome.try_recv() {
            Ok(outcome) => Some(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("it cannot be opened".to_owned())),
        }
    }
}
