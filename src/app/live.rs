//! A scene that follows its files: what changed is read and built beside what is shown, and takes
//! its place in one step; after a mistake the last good scene stays.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, SystemTime},
};

use super::{
    args::SceneArgs,
    error::AppError,
    model_viewer_scene::is_model,
    params::{DeclaredParameters, ParameterOverrides},
    scene::SceneText,
    watch::{Change, WatchList},
};
use crate::{
    gpu::{Gpu, ShaderError, ShaderLibrary},
    render::{RebuildSummary, RenderError, Renderer, stats::FrameStats},
    scene::{
        dependencies::Dependencies,
        desc::{CameraDesc, Method, SceneDesc, TimelineDesc},
        diagnostic::Diagnostic,
        stages::Scene,
    },
    world::{
        World,
        load::{self, AssetCache},
    },
};

mod catch_panic;
mod parameter_trial;
mod pose;
mod reload;
mod reload_job;

pub use parameter_trial::Refusal;
use parameter_trial::Trials;
pub use pose::Edit;
use reload::{Waiting, options_of, read_library};
pub use reload_job::{Done, ReloadJob, Reuse};
use reload_job::{Read, pose_of};

/// What is shown where there is no scene.
const NOTHING: &str = "version = 1\n[camera.main]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n";

/// Where a live scene comes from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// Scene file or model; `None` is the built-in atrium.
    pub path: Option<PathBuf>,
    /// What is changed in it, and where its files are.
    pub from: SceneArgs,
    /// Folder of shaders; `None` are the built-in ones.
    pub shaders: Option<PathBuf>,
}

/// What the viewer wants in place of what the scene says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewOverrides {
    /// Pixels.
    pub size: Option<[u32; 2]>,
    /// How reflections are found.
    pub method: Option<Method>,
    /// Sub-frames.
    pub samples: Option<u32>,
}

/// What keeps changes from being shown; the last good scene stays meanwhile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Problems {
    /// In the scene's text, script or files as they are on disk.
    pub scene: Vec<Diagnostic>,
    /// In the frame that is wanted; other frames may be without.
    pub pose: Vec<Diagnostic>,
    /// In a shader.
    pub shader: Option<ShaderError>,
    /// Why the device refused the last thing asked of it, such as a picture too large for it.
    pub refused: Option<String>,
}

impl Problems {
    /// Whether everything on disk is what is shown.
    pub fn is_empty(&self) -> bool {
        self.scene.is_empty()
            && self.pose.is_empty()
            && self.shader.is_none()
            && self.refused.is_none()
    }
}

/// What was done for some changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reload {
    /// Whether all of it is now shown.
    pub ok: bool,
    /// Model, image and other files were read.
    pub files: bool,
    /// Shaders that were checked and created.
    pub shaders: u32,
    /// Pipelines that the driver made.
    pub pipelines: u32,
    /// What the renderer made again.
    pub rebuilt: RebuildSummary,
    /// From the changes to being ready for the next frame.
    pub took: Duration,
    /// The part of it that texts were read, scripts run and the frame posed.
    pub parse: Duration,
    /// The part of it that the driver compiled pipelines.
    pub driver: Duration,
}

impl Reload {
    /// Both, one after the other.
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

/// A scene, its renderer and what is wrong with their files now.
#[derive(Debug)]
pub struct Live {
    gpu: Arc<Gpu>,
    origin: Origin,
    library: ShaderLibrary,
    scene: Arc<Scene>,
    world: World,
    asset_cache: AssetCache,
    renderer: Renderer,
    overrides: ViewOverrides,
    /// Models, images and other files that were looked for.
    dependencies: Dependencies,
    /// Scripts and included files that were looked for.
    texts: Dependencies,
    /// The same for a scene that is being read.
    pending_texts: Dependencies,
    read_since: SystemTime,
    declared: DeclaredParameters,
    parameters: ParameterOverrides,
    /// Values that may take its place.
    trials: Trials,
    edits: Vec<Edit>,
    /// The frame that is wanted, and the one that is shown.
    frame: u32,
    posed: u32,
    log: Vec<String>,
    /// What was saved, while the wanted frame of it cannot be posed.
    waiting: Option<Waiting>,
    /// Warnings about what is shown.
    pub warnings: Vec<Diagnostic>,
    /// What keeps the newest content from being shown.
    pub problems: Problems,
}

impl Live {
    /// Reads and builds everything for the first time, at the first frame.
    ///
    /// # Errors
    /// As the command `render`: there is nothing good to keep yet.
    pub fn open(gpu: Arc<Gpu>, origin: Origin, overrides: ViewOverrides) -> Result<Self, AppError> {
        let read_since = SystemTime::now();
        let texts = Dependencies::default();
        let read = reload_job::read(&origin, &ParameterOverrides::default(), &texts, 0);
        Self::build(
            gpu,
            origin,
            overrides,
            texts,
            read.map_err(AppError::Scene)?,
            read_since,
        )
    }

    /// An empty picture in place of a scene that has mistakes, until it is read anew without.
    ///
    /// # Errors
    /// As [`Live::open`], but none of the scene.
    pub fn open_waiting(
        gpu: Arc<Gpu>,
        origin: Origin,
        overrides: ViewOverrides,
        mistakes: Vec<Diagnostic>,
    ) -> Result<Self, AppError> {
        let empty = nothing(&origin).map_err(AppError::Scene)?;
        let (texts, now) = (Dependencies::default(), SystemTime::now());
        let mut live = Self::build(gpu, origin, overrides, texts, empty, now)?;
        live.warnings.clear(); // that there is nothing to see
        live.problems.scene = mistakes;
        Ok(live)
    }

    /// Builds what was read.
    fn build(
        gpu: Arc<Gpu>,
        origin: Origin,
        overrides: ViewOverrides,
        texts: Dependencies,
        read: Read,
        read_since: SystemTime,
    ) -> Result<Self, AppError> {
        let library = read_library(&origin).map_err(|e| AppError::from_user_shader(&e))?;
        let state = pose_of(&read.scene, read.frame).map_err(AppError::Scene)?;
        let loaded = load::load_with_cache(&read.scene, &read.options);
        let (mut world, asset_cache) = loaded.map_err(AppError::Scene)?;
        if let Some(state) = &state {
            world.apply(state).map_err(AppError::Scene)?;
        }
        let mut warnings = read.warnings;
        warnings.extend(world.warnings.iter().cloned());
        let renderer = Renderer::new(&gpu, &library, &world, &options_of(&read.scene, overrides));
        let renderer = renderer.map_err(|error| AppError::from_render(error, true))?;
        Ok(Self {
            gpu,
            origin,
            library,
            log: state.map_or_else(Vec::new, |state| state.log),
            scene: read.scene,
            world,
            asset_cache,
            renderer,
            overrides,
            dependencies: read.options.dependencies,
            texts,
            pending_texts: Dependencies::default(),
            read_since,
            declared: read.declared,
            parameters: read.parameters,
            trials: Trials::default(),
            edits: Vec::new(),
            frame: read.frame,
            posed: read.frame,
            waiting: None,
            warnings,
            problems: Problems::default(),
        })
    }

    /// What the shown scene was read from, and what was looked for since.
    pub fn watch_list(&self) -> (WatchList, SystemTime) {
        let kind = |path: &PathBuf| {
            if is_model(path) {
                Change::Asset
            } else {
                Change::Scene
            }
        };
        let scene = self.origin.path.iter();
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
        // Among the world's files these have their names without links.
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
            shader_folders: self.origin.shaders.iter().cloned().collect(),
        };
        (list, self.read_since)
    }

    /// Renders with other overrides from now on.
    ///
    /// # Errors
    /// A picture past the adapter's limits, or what a shader or wgpu refuses; then the old overrides
    /// stay.
    pub fn set_overrides(&mut self, overrides: ViewOverrides) -> Result<(), RenderError> {
        if overrides == self.overrides {
            return Ok(());
        }
        let options = options_of(&self.scene, overrides);
        let world = &self.world;
        (self.renderer).change(&self.gpu, &self.library, world, &options)?;
        self.overrides = overrides;
        Ok(())
    }

    /// Renders into the targets.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render(&mut self, camera: &CameraDesc) -> Result<FrameStats, RenderError> {
        self.renderer.render(&self.gpu, &self.world, camera)
    }

    /// The scene as written.
    pub fn desc(&self) -> &SceneDesc {
        &self.scene
    }

    /// The frames of the scene as it is on disk, also while it waits for one that can be posed.
    pub fn timeline(&self) -> Option<&TimelineDesc> {
        let waiting = self.waiting.as_ref().map(Waiting::scene);
        waiting.unwrap_or(&self.scene).timeline.as_ref()
    }

    /// The scene as loaded, at the frame that is shown.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What shows it.
    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Where it comes from.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The script's parameters as the scene declares them, with its `--set`.
    pub fn declared(&self) -> &DeclaredParameters {
        &self.declared
    }

    /// What is laid over them.
    pub fn parameters(&self) -> &ParameterOverrides {
        &self.parameters
    }

    /// The frame that is shown.
    pub fn posed_frame(&self) -> u32 {
        self.posed
    }

    /// What the script printed in `setup`, then in the frame that is shown.
    pub fn log(&self) -> impl Iterator<Item = &String> {
        let of_setup = self.scene.script.iter().flat_map(|s| &s.setup_log);
        of_setup.chain(&self.log)
    }
}

/// A scene with nothing in it.
fn nothing(origin: &Origin) -> Result<Read, Vec<Diagnostic>> {
    let from = SceneArgs {
        assets: origin.from.assets.clone(),
        ..SceneArgs::default()
    };
    let text = SceneText::new(NOTHING, Path::new("nothing"), &from);
    let opened = text.open(&[], &Dependencies::default())?;
    Ok(Read::new(opened, <_>::default(), <_>::default(), 0))
}
