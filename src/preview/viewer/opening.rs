//! Opens a scene to be looked at, also one with mistakes.

use std::{path::Path, sync::Arc, thread, time::Duration};

use super::{
    picture_filter::PictureFilter, render_thread::RenderThread, scene_summary::SceneSummary,
    view_state::ViewState,
};
use crate::live::{InitialBuild, Live, SceneSource, ViewOverrides};
use reflet_gpu::Gpu;
use reflet_render::runtime::SessionError;
use reflet_scene::{
    desc::{Method, Samples},
    diagnostic::print_diagnostics,
    script::Halt,
};

/// A scene is shown after this time even if its scripts have not ended.
const SCRIPT_WAIT: Duration = Duration::from_secs(1);

/// Options of a viewer and of its first scene.
#[derive(Clone, Debug)]
pub struct ViewerOptions {
    /// The scene, with changed values.
    pub source: SceneSource,
    /// Camera to look through at first; without a name the camera of the scene's cuts, else `main`, else the first.
    pub camera: Option<String>,
    /// Reflection method to show first, instead of the scene's.
    pub method: Option<Method>,
    /// Width and height of the window, or of the page's picture, pixels.
    pub size: [u32; 2],
    /// Filter of pictures at rest.
    pub denoiser: Option<PictureFilter>,
}

/// A loaded scene with its renderer, and the initial state of its viewer.
pub struct Opened {
    live: Live,
    /// Whether the scene must be reloaded at once.
    is_waiting: bool,
    /// Initial state of the viewer.
    pub state: ViewState,
    /// Name of the scene's file, without its ending.
    pub stem: String,
}

impl Opened {
    /// Opens the scene of the options.
    ///
    /// # Errors
    /// Errors of the scene, unless they are shown in place of its picture, and a camera that it does not have.
    pub fn new(gpu: &Arc<Gpu>, options: &ViewerOptions) -> Result<Self, SessionError> {
        let view = ViewOverrides {
            size: Some([64, 64]),
            method: options.method,
            unwritten_samples: Some(Samples::AT_REST),
            guides: options.denoiser.is_some(),
            ..ViewOverrides::default()
        };
        let waits = options.camera.is_none();
        let stem = options.source.path.as_deref().and_then(Path::file_stem);
        let stem = stem.map_or("atrium".into(), |stem| stem.to_string_lossy().into_owned());
        let (live, is_waiting) = open(gpu, options.source.clone(), view, waits)?;
        let camera = live.camera_named(options.camera.as_deref())?;
        let summary = SceneSummary::from_live(&live);
        let method = options.method.unwrap_or(summary.method);
        Ok(Self {
            live,
            is_waiting,
            state: ViewState::new(summary, method, camera, waits),
            stem,
        })
    }

    /// Starts rendering; `on_report` is called with each report.
    pub fn start(
        self,
        gpu: &Arc<Gpu>,
        denoiser: Option<PictureFilter>,
        on_report: impl Fn() + Send + Sync + 'static,
    ) -> (RenderThread, ViewState) {
        let (live, waits) = (self.live, self.is_waiting);
        let thread = RenderThread::start(gpu.clone(), live, waits, denoiser, on_report);
        (thread, self.state)
    }
}

/// The scene, and whether it must be reloaded: errors in an existing scene file are shown
/// in place of its picture until they are mended, if `waits`. The same holds for a slow script.
///
/// # Errors
/// Same errors as [`Live::open`], unless `waits`.
pub fn open(
    gpu: &Arc<Gpu>,
    source: SceneSource,
    overrides: ViewOverrides,
    waits: bool,
) -> Result<(Live, bool), SessionError> {
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
        Err(SessionError::Scene(errors)) if waits => {
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
