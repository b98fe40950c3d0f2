//! Hot reload of a scene: changed files are read and built beside the current scene and replace it
//! in one step; after an error the last good scene stays.

use std::{
    collections::BTreeSet,
    path::PathBuf,
    sync::Arc,
    time::{Duration, SystemTime},
};

use super::{
    args::SceneArgs,
    params::{DeclaredParameters, ParameterOverrides},
    watch::{Change, WatchList},
    write_back::History,
};
use crate::{
    gpu::{Gpu, ShaderError, ShaderLibrary},
    render::{
        RebuildSummary, RenderError, Renderer, shutter::Moments, stats::FrameStats,
        unit_costs::UnitCosts,
    },
    scene::{
        dependencies::Dependencies,
        desc::{CameraDesc, Method, SceneDesc, TimelineDesc},
        diagnostic::Diagnostic,
        stages::Scene,
    },
    session::{
        model_viewer_scene::is_model,
        open_shutter::{self, OpenShutter},
    },
    world::{World, load::AssetCache},
};

mod catch_panic;
mod coarse;
mod open;
mod parameter_trial;
mod pose;
mod reload;
mod reload_job;
mod write_back;

pub use open::InitialBuild;
pub use parameter_trial::Refusal;
use parameter_trial::TrialState;
pub use pose::Edit;
use reload::{PendingScene, options_of};
pub use reload_job::{FinishedJob, ReloadJob, Reuse};

/// Files and arguments of a live scene.
#[derive(Clone, Debug)]
pub struct SceneSource {
    /// Scene file or model; `None` is the built-in atrium.
    pub path: Option<PathBuf>,
    /// Overrides and asset folders.
    pub args: SceneArgs,
    /// Shader folder; `None` for the built-in shaders.
    pub shaders: Option<PathBuf>,
}

/// View settings that replace those of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewOverrides {
    /// Picture size, pixels.
    pub size: Option<[u32; 2]>,
    /// Reflection method.
    pub method: Option<Method>,
    /// Sub-frames per picture.
    pub samples: Option<u32>,
    /// See [`crate::render::RenderOptions::costs`].
    pub costs: Option<UnitCosts>,
}

/// Errors that keep changes from being shown; the last good scene stays meanwhile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Problems {
    /// Errors in the scene's text, script or files on disk.
    pub scene: Vec<Diagnostic>,
    /// Errors in the requested frame; other frames may be valid.
    pub pose: Vec<Diagnostic>,
    /// Shader error.
    pub shader: Option<ShaderError>,
    /// Error of the last device operation, such as a picture past its limits.
    pub refused: Option<String>,
}

impl Problems {
    /// Whether the newest content on disk is shown.
    pub fn is_empty(&self) -> bool {
        self.scene.is_empty()
            && self.pose.is_empty()
            && self.shader.is_none()
            && self.refused.is_none()
    }
}

/// Work done for a set of changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reload {
    /// Whether all changes are shown.
    pub ok: bool,
    /// Whether models, images and other files were read.
    pub files: bool,
    /// Number of shader modules created.
    pub shaders: u32,
    /// Number of pipelines created.
    pub pipelines: u32,
    /// Renderer parts that were rebuilt.
    pub rebuilt: RebuildSummary,
    /// Total time until the next frame can be rendered.
    pub took: Duration,
    /// Part of `took` for reading texts, running scripts and posing the frame.
    pub parse: Duration,
    /// Part of `took` for pipeline compilation by the driver.
    pub driver: Duration,
}

impl Reload {
    /// Sum of two consecutive reloads.
    pub fn and(self, next: Self) -> Self {
        Self {
            ok: self.ok && next.ok,
            files: self.files || next.files,
            shaders: self.shaders + next.shaders,
            pipelines: self.pipelines + next.pipelines,
            rebuilt: self.rebuilt.merged(next.rebuilt),
            took: self.took + next.took,
            parse: self.parse + next.parse,
            driver: self.driver + next.driver,
        }
    }
}

/// A scene with its renderer and the current errors in its files.
#[derive(Debug)]
pub struct Live {
    gpu: Arc<Gpu>,
    source: SceneSource,
    library: ShaderLibrary,
    scene: Arc<Scene>,
    world: World,
    asset_cache: AssetCache,
    renderer: Renderer,
    /// World of the coarse first picture, until [`Live::complete`] has built the rest.
    coarse: Option<World>,
    /// Method that was decided for a scene with method `auto`, before the view chose another.
    auto_method: Method,
    overrides: ViewOverrides,
    /// Models, images and other files, existing or not.
    dependencies: Dependencies,
    /// Scripts and included files, existing or not.
    texts: Dependencies,
    /// Scripts and included files of a scene that is being read.
    pending_texts: Dependencies,
    read_since: SystemTime,
    declared: DeclaredParameters,
    parameters: ParameterOverrides,
    /// Requested values that are not accepted yet.
    trial: TrialState,
    edits: Vec<Edit>,
    history: History,
    /// The scene on disk while another one is shown by a drag.
    undragged: Option<Arc<Scene>>,
    /// Requested frame, and shown frame.
    frame: u32,
    posed: u32,
    log: Vec<String>,
    /// A saved scene whose requested frame cannot be posed.
    pending: Option<PendingScene>,
    /// Warnings about the shown scene.
    pub warnings: Vec<Diagnostic>,
    /// Errors that keep the newest content from being shown.
    pub problems: Problems,
}

impl Live {
    /// Files to watch: those of the shown scene and those searched since, with the time of the
    /// read.
    pub fn watch_list(&self) -> (WatchList, SystemTime) {
        let kind = |path: &PathBuf| {
            if is_model(path) {
                Change::Asset
            } else {
                Change::Scene
            }
        };
        let scene = self.source.path.iter();
        let scene = scene.map(|path| (path.clone(), kind(path)));
        let texts = [&self.texts, &self.pending_texts]
            .into_iter()
            .flat_map(Dependencies::paths);
        let texts = texts.map(|path| {
            let is_script = path.extension().is_some_and(|e| e == "rhai");
            let kind = if is_script {
                Change::Script
            } else {
                Change::Scene
            };
            (path, kind)
        });
        // The world lists these files by their resolved paths.
        let resolved = self.scene.text_files();
        let read = self
            .world
            .files
            .iter()
            .cloned()
            .chain(self.dependencies.paths());
        let assets = read
            .filter(|path| !resolved.contains(path))
            .map(|path| (path, Change::Asset));
        let files: BTreeSet<(PathBuf, Change)> = scene.chain(texts).chain(assets).collect();
        let list = WatchList {
            files: files.into_iter().collect(),
            shader_folders: self.source.shaders.iter().cloned().collect(),
        };
        (list, self.read_since)
    }

    /// View settings in effect.
    pub fn overrides(&self) -> ViewOverrides {
        self.overrides
    }

    /// Changes the overrides.
    ///
    /// # Errors
    /// A picture past the adapter's limits, a shader or wgpu error; then the old overrides stay.
    pub fn set_overrides(&mut self, overrides: ViewOverrides) -> Result<(), RenderError> {
        if overrides == self.overrides {
            return Ok(());
        }
        let options = options_of(&self.scene, overrides);
        let (world, options) = match &self.coarse {
            Some(coarse) => (coarse, coarse::options(options)),
            None => (&self.world, options),
        };
        (self.renderer).change(&self.gpu, &self.library, world, &options)?;
        self.overrides = overrides;
        Ok(())
    }

    /// Renders into the targets.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`].
    pub fn render(&mut self, camera: &CameraDesc) -> Result<FrameStats, RenderError> {
        self.render_by(&|_| camera.clone())
    }

    /// Renders into the targets with a camera that may move with the world: while the shutter is open, each
    /// sub-frame shows another moment.
    ///
    /// # Errors
    /// Same errors as [`Live::render`], and errors of a script at one of the moments.
    pub fn render_by(
        &mut self,
        camera: &dyn Fn(&World) -> CameraDesc,
    ) -> Result<FrameStats, RenderError> {
        let samples = self.renderer.options().image.samples;
        if self.coarse.is_some() || !open_shutter::moves(&self.scene, samples) {
            let world = self.coarse.as_ref().unwrap_or(&self.world);
            return self.renderer.render(&self.gpu, world, &camera(world));
        }
        let edits = &self.edits;
        let edited = |world: &mut World| edits.iter().for_each(|edit| edit.put(world));
        let mut moments = OpenShutter::new(&self.scene, &mut self.world, self.posed, &edited);
        let rendered = (self.renderer).render_moments(&self.gpu, &mut moments, camera);
        if rendered.is_err() {
            // Picking and inspection need the pose of the frame, which was valid before.
            let _ = moments.pose(samples - 1, samples);
            let _ = self.renderer.update(&self.gpu, &self.world);
        }
        rendered
    }

    /// Scene description.
    pub fn desc(&self) -> &SceneDesc {
        &self.scene
    }

    /// Timeline of the scene on disk, also of a pending one.
    pub fn timeline(&self) -> Option<&TimelineDesc> {
        let pending = self.pending.as_ref().map(PendingScene::scene);
        pending.unwrap_or(&self.scene).timeline.as_ref()
    }

    /// Loaded scene, posed at the shown frame.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Renderer of the scene.
    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Method of the scene; for `auto`, the one that was decided last.
    pub fn scene_method(&self) -> Method {
        match self.scene.reflection.method {
            Method::Auto => self.auto_method,
            method => method,
        }
    }

    /// Files and arguments of the scene.
    pub fn source(&self) -> &SceneSource {
        &self.source
    }

    /// Shown frame.
    pub fn posed_frame(&self) -> u32 {
        self.posed
    }

    /// Output of the script in `setup`, then in the shown frame.
    pub fn log(&self) -> impl Iterator<Item = &String> {
        let of_setup = self.scene.scripts().flat_map(|s| &s.setup_log);
        of_setup.chain(&self.log)
    }
}
