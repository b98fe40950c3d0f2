//! A scene that follows its files: changed files are read and built beside the shown scene and replace it in one step;
//! after an error the last good scene stays.

use std::{
    collections::BTreeSet,
    ops::Deref,
    path::PathBuf,
    sync::Arc,
    time::{Duration, SystemTime},
};

use super::watch::{Change, WatchList};
use reflet_gpu::ShaderError;
use reflet_render::{
    RebuildSummary, RenderError,
    renderer::stats::FrameStats,
    runtime::{Session, model_viewer_scene::is_bare},
};
use reflet_scene::{
    dependencies::Dependencies,
    desc::{CameraDesc, SceneDesc, TimelineDesc},
    diagnostic::Diagnostic,
    stages::Scene,
};
use reflet_world::World;

mod history;
mod open;
mod pending;
mod pose;
mod reload;
mod reload_job;
mod write_back;

use history::History;
use pending::Pending;
pub use pending::{ReadRequest, Refusal, Reuse};
pub use pose::Edit;
pub use reflet_render::runtime::{InitialBuild, SceneSource, ViewOverrides};
pub use reload_job::{FinishedJob, ReloadJob};

/// Errors that keep changes from being shown; the last good scene stays meanwhile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Problems {
    /// Errors in the scene's text, script or files on disk.
    pub scene: Vec<Diagnostic>,
    /// Errors in the requested frame; other frames may be valid.
    pub pose: Vec<Diagnostic>,
    /// Reason for which the device cannot show the scene on disk.
    pub unbuilt_scene: Option<BuildProblem>,
    /// Reason for which the shaders on disk are not in use.
    pub unbuilt_shaders: Option<BuildProblem>,
    /// Error of the last picture, such as one past the limits of the device.
    pub undrawn: Option<String>,
}

/// Error that keeps a scene or shaders from being built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildProblem {
    /// Error in a shader.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// Any other error, such as a limit of the device.
    #[error("{0}")]
    Device(String),
}

impl Problems {
    /// Whether the newest content on disk is shown.
    pub fn is_empty(&self) -> bool {
        self.scene.is_empty()
            && self.pose.is_empty()
            && self.unbuilt().next().is_none()
            && self.undrawn.is_none()
    }

    /// Errors that keep the scene or the shaders on disk from being built.
    pub fn unbuilt(&self) -> impl Iterator<Item = &BuildProblem> {
        self.unbuilt_scene.iter().chain(&self.unbuilt_shaders)
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
    /// No work, and nothing that is not shown.
    pub const NONE: Self = Self {
        ok: true,
        files: false,
        shaders: 0,
        pipelines: 0,
        rebuilt: RebuildSummary::NONE,
        took: Duration::ZERO,
        parse: Duration::ZERO,
        driver: Duration::ZERO,
    };

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

/// A session that follows its files, with edits that are not in them and the errors that they have.
#[derive(Debug)]
pub struct Live {
    session: Session,
    /// Changes that are asked for and not shown yet.
    pending: Pending,
    /// Scripts and included files, existing or not.
    texts: Dependencies,
    /// Scripts and included files of a scene that is being read.
    pending_texts: Dependencies,
    read_since: SystemTime,
    edits: Vec<Edit>,
    history: History,
    /// The scene on disk while another one is shown by a drag.
    undragged: Option<Arc<Scene>>,
    /// Requested frame.
    frame: u32,
    /// Whether what is shown stands in for a scene that could not be opened.
    is_stand_in: bool,
    /// Errors that keep the newest content from being shown.
    pub problems: Problems,
}

impl Live {
    /// Files to watch: read for the shown scene or searched since, with the time of the read.
    pub fn watch_list(&self) -> (WatchList, SystemTime) {
        let kind = |path: &PathBuf| {
            if is_bare(path) {
                Change::Asset
            } else {
                Change::Scene
            }
        };
        let source = self.session.source();
        let scene = source.path.iter();
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
        let resolved = self.desc().text_files();
        let read = self
            .world()
            .files
            .iter()
            .cloned()
            .chain(self.session.dependencies().paths());
        let assets = read
            .filter(|path| !resolved.contains(path))
            .map(|path| (path, Change::Asset));
        let files: BTreeSet<(PathBuf, Change)> = scene.chain(texts).chain(assets).collect();
        let list = WatchList {
            files: files.into_iter().collect(),
            shader_folders: source.shaders.iter().cloned().collect(),
        };
        (list, self.read_since)
    }

    /// Replaces view settings; passes are always audited.
    ///
    /// # Errors
    /// Same errors as [`Session::set_view`]; then the old settings stay.
    pub fn set_view(&mut self, view: ViewOverrides) -> Result<(), RenderError> {
        self.session.set_view(audited(view))
    }

    /// Number of sub-frames of a whole picture.
    pub fn samples(&self) -> u32 {
        let options = self.view().options(self.session.scene());
        options.image.samples.count()
    }

    /// Renders into the targets with a camera that may move with the world: while the shutter is open, each
    /// sub-frame shows another moment.
    ///
    /// # Errors
    /// Same errors as [`Session::draw`].
    pub fn render(
        &mut self,
        camera: &dyn Fn(&World) -> CameraDesc,
    ) -> Result<FrameStats, RenderError> {
        let edits = &self.edits;
        self.session
            .draw(camera, &|world| pose::put_all(edits, world))
    }

    /// Builds the features that the coarse picture leaves out.
    ///
    /// # Errors
    /// Same errors as [`Session::complete`].
    pub fn complete(&mut self) -> Result<(), RenderError> {
        self.session.complete()
    }

    /// Scene description.
    pub fn desc(&self) -> &SceneDesc {
        &self.session.scene().scene
    }

    /// Timeline of the scene on disk, also of a pending one.
    pub fn timeline(&self) -> Option<&TimelineDesc> {
        let pending = self.pending.scene().map(|scene| &scene.desc);
        pending.unwrap_or(self.desc()).timeline.as_ref()
    }

    /// Loaded scene, posed at the shown frame.
    pub fn world(&self) -> &World {
        &self.session.scene().world
    }

    /// Warnings about the shown scene.
    pub fn warnings(&self) -> &[Diagnostic] {
        match self.is_stand_in {
            true => &[],
            false => self.session.warnings(),
        }
    }
}

impl Deref for Live {
    type Target = Session;

    /// The shown scene, with its settings and its renderer.
    fn deref(&self) -> &Session {
        &self.session
    }
}

/// The preview counts what the audit says.
fn audited(view: ViewOverrides) -> ViewOverrides {
    ViewOverrides {
        audit: true,
        ..view
    }
}
