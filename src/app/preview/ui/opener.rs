//! Opens scenes: the one of the command line, and those that are dropped on the window or chosen in it.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        mpsc::{self, Receiver, TryRecvError},
    },
    thread,
    time::Duration,
};

use eframe::egui;

use super::window::Window;
use crate::{
    app::{
        args::PreviewArgs,
        error::{AppError, print_diagnostics},
        live::{InitialBuild, Live, SceneSource, ViewOverrides},
        plan_file::costs,
        preview::{render_thread::RenderThread, scene_summary::SceneSummary},
    },
    gpu::Gpu,
    scene::{desc::Method, script::Halt},
};

/// A scene is shown after this time even if its scripts have not ended.
const SCRIPT_WAIT: Duration = Duration::from_secs(1);

/// Device, arguments and settings with which scenes are opened.
#[derive(Clone)]
pub struct Opener {
    gpu: Arc<Gpu>,
    source: SceneSource,
    overrides: ViewOverrides,
    method: Option<Method>,
    screenshots: PathBuf,
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
    /// Opener for the arguments of a command line; screenshots go into the folder `screenshots`.
    ///
    /// # Errors
    /// A plan file that cannot be used.
    pub fn new(gpu: Arc<Gpu>, args: &PreviewArgs, screenshots: PathBuf) -> Result<Self, AppError> {
        let method = args.method.map(Method::from);
        let plan = args.plan.as_deref();
        let overrides = ViewOverrides {
            size: Some([64, 64]),
            method,
            costs: plan.map(|path| costs(path, &gpu)).transpose()?,
            ..ViewOverrides::default()
        };
        let source = SceneSource {
            path: args.scene.clone(),
            options: args.from.options(),
            shaders: args.shaders.clone(),
        };
        Ok(Self {
            gpu,
            source,
            overrides,
            method,
            screenshots,
        })
    }

    /// Opens the scene of the command line, shown by the camera of this name.
    ///
    /// # Errors
    /// Same errors as [`open`], and a camera that the scene does not have.
    pub fn first(&self, camera: Option<&str>) -> Result<Opened, AppError> {
        self.open(self.source.clone(), camera)
    }

    /// Opens another scene or model, without the `--set` and `--variant` of the first one.
    ///
    /// # Errors
    /// Same errors as [`open`].
    pub fn another(&self, path: &Path) -> Result<Opened, AppError> {
        let mut source = self.source.clone();
        source.path = Some(path.to_owned());
        (source.options.set, source.options.variant) = (Vec::new(), Vec::new());
        self.open(source, None)
    }

    fn open(&self, source: SceneSource, camera: Option<&str>) -> Result<Opened, AppError> {
        let stem = source.path.as_deref().and_then(Path::file_stem);
        let stem = stem.map_or("atrium".into(), |stem| stem.to_string_lossy().into_owned());
        let opened = open(&self.gpu, source, self.overrides.clone(), camera.is_none());
        let (live, is_waiting) = opened?;
        print_diagnostics(live.warnings());
        let summary = SceneSummary::of(&live);
        Ok(Opened {
            live,
            is_waiting,
            method: self.method.unwrap_or(summary.method),
            camera: choose_camera(&summary, camera)?,
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
        let thread = RenderThread::start(self.gpu.clone(), live, is_waiting, repaint);
        let place = (self.screenshots.clone(), opened.stem);
        let mut window = Window::new(thread, opened.summary, opened.method, opened.camera, place);
        window.set_follows_cuts(opened.follows_cuts);
        window
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

/// The scene, and whether it must be reloaded: errors in an existing scene file are shown in the
/// window, which waits for a fix if `waits`. The same holds for a slow script.
///
/// # Errors
/// Same errors as [`Live::open`], unless `waits`.
pub fn open(
    gpu: &Arc<Gpu>,
    source: SceneSource,
    overrides: ViewOverrides,
    waits: bool,
) -> Result<(Live, bool), AppError> {
    let waits = waits && source.path.as_deref().is_some_and(Path::is_file);
    let halt = Halt::default();
    if waits {
        let halt = halt.clone();
        thread::spawn(move || {
            thread::sleep(SCRIPT_WAIT);
            halt.halt();
        });
    }
    match halt.over(|| {
        Live::open(
            gpu.clone(),
            source.clone(),
            overrides.clone(),
            InitialBuild::Coarse,
        )
    }) {
        Err(AppError::Scene(errors)) if waits => {
            let mistakes = if halt.is_halted() { Vec::new() } else { errors };
            print_diagnostics(&mistakes);
            Ok((
                Live::open_empty(gpu.clone(), source, overrides, mistakes)?,
                true,
            ))
        }
        opened => Ok((opened?, false)),
    }
}

/// Index of the named camera; without a name `main`, else the first.
fn choose_camera(summary: &SceneSummary, name: Option<&str>) -> Result<usize, AppError> {
    let place = |name: &str| summary.cameras.iter().position(|(known, _)| known == name);
    match name {
        None => Ok(place("main").unwrap_or(0)),
        Some(name) => place(name).ok_or_else(|| {
            let known: Vec<&str> = summary
                .cameras
                .iter()
                .map(|(name, _)| name.as_str())
                .collect();
            let known = known.join(", ");
            AppError::Usage(format!("--camera {name}: the scene has: {known}"))
        }),
    }
}
