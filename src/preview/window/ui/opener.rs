//! Opens scenes: the first one, and scenes that are dropped on the window or chosen in it.

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
use crate::viewer::opening::{Opened, ViewerOptions};
use reflet_gpu::Gpu;
use reflet_render::runtime::SessionError;
use reflet_scene::diagnostic::print_diagnostics;

/// Device and options with which scenes are opened.
#[derive(Clone)]
pub struct Opener {
    gpu: Arc<Gpu>,
    options: ViewerOptions,
    /// Folder for screenshots.
    screenshots: PathBuf,
}

impl Opener {
    /// Opener for the options of a window.
    pub fn new(gpu: Arc<Gpu>, options: &ViewerOptions, screenshots: PathBuf) -> Self {
        Self {
            gpu,
            options: options.clone(),
            screenshots,
        }
    }

    /// Opens the first scene.
    ///
    /// # Errors
    /// Same errors as [`Opened::new`].
    pub fn first(&self) -> Result<Opened, SessionError> {
        self.open(&self.options)
    }

    /// Opens another scene or model, without the `--set` and `--variant` of the first one.
    ///
    /// # Errors
    /// Same errors as [`Opened::new`].
    pub fn another(&self, path: &Path) -> Result<Opened, SessionError> {
        let mut options = self.options.clone();
        let source = &mut options.source;
        source.path = Some(path.to_owned());
        (source.options.set, source.options.variant) = (Vec::new(), Vec::new());
        options.camera = None;
        self.open(&options)
    }

    fn open(&self, options: &ViewerOptions) -> Result<Opened, SessionError> {
        let opened = Opened::new(&self.gpu, options)?;
        print_diagnostics(&opened.state.summary.warnings);
        Ok(opened)
    }

    /// Title of the window.
    pub fn title(&self, opened: &Opened) -> String {
        format!("{} – Reflet on {}", opened.stem, self.gpu.adapter_info.name)
    }

    /// Starts rendering, and repaints the window of the context with each report.
    pub fn start(&self, opened: Opened, context: &egui::Context) -> Window {
        let repaint = context.clone();
        let stem = opened.stem.clone();
        let denoiser = self.options.denoiser.clone();
        let (thread, state) = opened.start(&self.gpu, denoiser, move || repaint.request_repaint());
        Window::new(thread, state, self.screenshots.clone(), stem)
    }
}

/// A scene that is being opened beside the shown scene.
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
